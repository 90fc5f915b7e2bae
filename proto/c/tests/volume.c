/*
 * A block with fields on a volume, for the system tests, in the role `volume` of cases/volume.toml;
 * tests/src/volume.rs has its laws.
 */
#include <cosim.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const DESCRIPTION = COSIM_JSON({
    "name": "block", "version": "1", "role": "volume", "standalone": true,
    "reusable": true,
    "models": [{"name": "law", "summary": "a law", "source": "a closed form",
                "steady": true, "transient": true,
                "provides": ["volume_temperature", "volume_place"]}],
    "keys": [
        {"path": "volume.elements", "type": "integer", "default": 8, "help": "along the block"},
        {"path": "volume.hexahedra", "type": "text", "default": "structured", "help": "their kind"},
        {"path": "volume.fault", "type": "text", "default": "none", "help": "way to misbehave"}
    ],
    "fields": [
        {"name": "volume_temperature", "unit": "K", "components": 1, "mapping": "consistent",
         "body": "interface", "meaning": "temperature in the block"},
        {"name": "volume_place", "unit": "m", "components": 3, "mapping": "consistent",
         "body": "interface", "meaning": "centres of the block's elements"}
    ]
});

struct block {
    cosim_volume volume;
    size_t n[3];
    char fault[32];
    int bent;
    unsigned windows;
};

static size_t index_of(const struct block *block, size_t i, size_t j, size_t k)
{
    return (k * (block->n[1] + 1) + j) * (block->n[0] + 1) + i;
}

static double node(size_t at, size_t count)
{
    double u = (double)at / (double)count;
    return 0.5 * u * (1.0 + u);
}

static void vertex(const struct block *block, size_t i, size_t j, size_t k, double place[3])
{
    double u = node(i, block->n[0]), v = node(j, block->n[1]);
    place[0] = block->bent ? (1.0 + v) * sin(u) : 2.0 * u;
    place[1] = block->bent ? (1.0 + v) * cos(u) : v;
    place[2] = 0.5 * node(k, block->n[2]);
}

/* Corner c of element (i, j, k) is the vertex (i + di, j + dj, k + dk), in VTK's order. */
static void shift(int c, size_t d[3])
{
    d[0] = c % 4 == 1 || c % 4 == 2;
    d[1] = c % 4 >= 2;
    d[2] = c >= 4;
}

static const char *describe(void *user)
{
    (void)user;
    return DESCRIPTION;
}

static int configure(void *user, const cosim_configuration *told, cosim_layout *layout)
{
    struct block *block = user;
    block->windows = 0;
    int64_t along;
    const char *kind = cosim_case_text(told, "volume.hexahedra");
    const char *fault = cosim_case_text(told, "volume.fault");
    if (!kind || !fault || cosim_case_integer(told, "volume.elements", &along))
        return COSIM_REFUSED;
    snprintf(block->fault, sizeof block->fault, "%s", fault);
    block->n[0] = (size_t)along;
    block->n[1] = (block->n[0] + 1) / 2;
    block->n[2] = (block->n[0] + 3) / 4;
    block->bent = strcmp(kind, "rectilinear") != 0;
    block->volume = (cosim_volume){
        .name = "block", .kind = COSIM_STRUCTURED_HEXAHEDRA,
        .ni = block->n[0], .nj = block->n[1], .nk = block->n[2],
        .vertices = (block->n[0] + 1) * (block->n[1] + 1) * (block->n[2] + 1),
        .elements = block->n[0] * block->n[1] * block->n[2],
    };
    if (!block->bent)
        block->volume.kind = COSIM_RECTILINEAR;
    if (strcmp(kind, "unstructured") == 0)
        block->volume.kind = COSIM_UNSTRUCTURED_HEXAHEDRA;
    return cosim_layout_volume(layout, &block->volume) ||
           cosim_layout_output(layout, "volume_temperature", "block") ||
           cosim_layout_output(layout, "volume_place", "block");
}

static int moved_grids(void *user, cosim_moves *moves)
{
    struct block *block = user;
    size_t count = 0;
    double *values = cosim_geometry(moves, "block", 1, &count);
    size_t vectors = count / 3, *n = block->n, at = 0, d[3];
    if (!values || strcmp(block->fault, "unwritten") == 0)
        return COSIM_OK;
    memset(values, 0, count * sizeof *values);
    if (!block->bent) {
        for (int c = 0; c < 3; c++)
            for (size_t i = 0; i <= n[c]; i++)
                values[(size_t)c * vectors + i] = (c == 0 ? 2.0 : c == 1 ? 1.0 : 0.5) * node(i, n[c]);
        return COSIM_OK;
    }
    for (size_t k = 0; k <= n[2]; k++)
        for (size_t j = 0; j <= n[1]; j++)
            for (size_t i = 0; i <= n[0]; i++, at++) {
                double place[3];
                vertex(block, i, j, k, place);
                for (int c = 0; c < 3; c++)
                    values[(size_t)c * vectors + at] = place[c];
            }
    if (block->volume.kind == COSIM_STRUCTURED_HEXAHEDRA)
        return COSIM_OK;
    for (size_t k = 0; k < n[2]; k++)
        for (size_t j = 0; j < n[1]; j++)
            for (size_t i = 0; i < n[0]; i++, at += 3)
                for (int c = 0; c < 8; c++) {
                    shift(c, d);
                    values[(size_t)(c % 3) * vectors + at + (size_t)c / 3] =
                        (double)index_of(block, i + d[0], j + d[1], k + d[2]);
                }
    return COSIM_OK;
}

static int solve(void *user, const cosim_step *step, const cosim_inputs *inputs,
                 cosim_outputs *outputs, cosim_report *report)
{
    (void)user, (void)step, (void)inputs, (void)outputs;
    report->substeps = 1;
    return COSIM_OK;
}

static int accept(void *user)
{
    ((struct block *)user)->windows++;
    return COSIM_OK;
}

static int observe(void *user, cosim_outputs *outputs)
{
    struct block *block = user;
    size_t count = 0, *n = block->n, at = 0, d[3];
    double *temperature = cosim_output(outputs, "volume_temperature", &count);
    double *places = cosim_output(outputs, "volume_place", NULL);
    if (!temperature || !places)
        return cosim_fail("both fields must be requested, or none");

    for (size_t k = 0; k < n[2]; k++)
        for (size_t j = 0; j < n[1]; j++)
            for (size_t i = 0; i < n[0]; i++, at++) {
                double centre[3] = {0.0, 0.0, 0.0}, place[3];
                for (int corner = 0; corner < 8; corner++) {
                    shift(corner, d);
                    vertex(block, i + d[0], j + d[1], k + d[2], place);
                    for (int c = 0; c < 3; c++)
                        centre[c] += place[c] / 8.0;
                }
                for (int c = 0; c < 3; c++)
                    places[(size_t)c * count + at] = centre[c];
                temperature[at] = (1.0 + block->windows) *
                                  (2.0 + sin(1.3 * centre[0]) * cos(0.9 * centre[1]) + centre[2]);
            }
    return COSIM_OK;
}

static int save(void *user, cosim_blob *blob)
{
    struct block *block = user;
    return cosim_blob_write(blob, &block->windows, sizeof block->windows);
}

static int restore(void *user, cosim_blob *blob)
{
    struct block *block = user;
    return cosim_blob_read(blob, &block->windows, sizeof block->windows);
}

int main(int argc, char **argv)
{
    struct block block = {0};
    cosim_solver solver = {
        .size = sizeof solver, .version = COSIM_VERSION,
        .describe = describe, .configure = configure, .solve = solve, .accept = accept,
        .observe = observe, .save = save, .restore = restore, .moved_grids = moved_grids,
    };
    return cosim_main(argc, argv, &solver, &block);
}
