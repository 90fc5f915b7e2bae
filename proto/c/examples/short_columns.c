/*
 * A complete thermal solver in C: heat conduction normal to the surface, in strips.
 *
 *     T(x) = 1/(beta sqrt(pi V)) int q/2 dx'/sqrt(x' - x)  upstream,
 *
 * with q constant over elements and half of the heat flowing into each body; beta is a body's
 * effusivity, V the speed of its surface through the contact (Carslaw & Jaeger, Conduction of Heat
 * in Solids, 2.9).
 */
#include <cosim.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

static const char *const SURFACE[] = {"lower_temperature", "upper_temperature"};

static const char *const DESCRIPTION = COSIM_JSON({
    "name": "short-columns", "version": "1.0", "role": "thermal", "reusable": true,
    "models": [{
        "name": "short", "steady": true, "transient": false,
        "summary": "Abel's integral", "source": "Carslaw & Jaeger, Conduction of Heat in Solids, 2.9",
        "consumes": ["friction_power", "surface_speed"], "provides": ["lower_temperature", "upper_temperature"]
    }],
    "effects": [{
        "name": "friction_heat", "models": ["short"], "law": "q/2 into each body", "source": "symmetry",
        "consumes": ["friction_power", "surface_speed"], "provides": ["lower_temperature", "upper_temperature"],
        "keys": [{"path": "effects.friction_heat.partition", "type": "choice", "of": ["equal"],
                  "default": "equal", "help": "one half each"}]
    }],
    "keys": [
        {"path": "bodies.*.position", "type": "choice", "of": ["upper", "lower"], "required": true,
         "help": "which of the two bodies it is"},
        {"path": "bodies.*.material", "type": "name-in", "table": "materials", "required": true,
         "help": "material of the body"},
        {"path": "materials.*.density", "type": "quantity", "unit": "kg/m3", "required": true,
         "above": 0, "help": "density"},
        {"path": "materials.*.specific_heat", "type": "quantity", "unit": "J/(kg K)",
         "required": true, "above": 0, "help": "specific heat"},
        {"path": "materials.*.conductivity", "type": "quantity", "unit": "W/(m K)",
         "required": true, "above": 0, "help": "conductivity"}
    ],
    "figures": [{"key": "temperature.*.max_rise_k", "unit": "K", "words": "temperature rise", "line": "*",
                 "style": "signed", "headline": true, "rank": 1}]
});

struct columns {
    cosim_grid grid; /* of the flux and of both temperatures */
    char name[2][32]; /* names of the bodies, in the order of SURFACE */
    double scale[2];  /* 1/(beta sqrt(pi)) of each body, in that order [K m^2/(W sqrt(s))] */
    double *shape;   /* int dx'/(2 sqrt(x' - x)) over the element itself, the next one upstream, ... [sqrt(m)] */
    double *trial, *accepted; /* sums over the elements upstream [W/m^1.5], and behind them for each
                                 body the factor 1/(beta sqrt(pi V)) to its rise [K m^1.5/W] */
    char summary[256];
};

static const char *describe(void *user)
{
    (void)user;
    return DESCRIPTION;
}

static int read_body(const cosim_configuration *told, int body, char kept[32], double *scale)
{
    static const char *const PROPERTY[] = {"density", "specific_heat", "conductivity"};
    char key[256];
    double product = PI;
    const char *name = cosim_body_name(told, body);
    if (!name)
        return COSIM_REFUSED;
    snprintf(kept, 32, "%s", name);
    snprintf(key, sizeof key, "bodies.%s.material", name);
    const char *material = cosim_case_text(told, key);
    if (!material)
        return COSIM_REFUSED;
    for (int p = 0; p < 3; p++) {
        double value;
        snprintf(key, sizeof key, "materials.%s.%s", material, PROPERTY[p]);
        if (cosim_case_number(told, key, &value))
            return COSIM_REFUSED;
        product *= value;
    }
    *scale = 1.0 / sqrt(product);
    return COSIM_OK;
}

static int configure(void *user, const cosim_configuration *told, cosim_layout *layout)
{
    struct columns *c = user;
    if (read_body(told, COSIM_LOWER, c->name[0], &c->scale[0]) || read_body(told, COSIM_UPPER, c->name[1], &c->scale[1]))
        return COSIM_REFUSED;
    if (!cosim_input_grid(told, "friction_power", &c->grid))
        return COSIM_OK; /* the grid is unknown while planning */
    if (c->grid.kind != COSIM_STRUCTURED)
        return cosim_refuse("mech.model", "its grid has no rows along x", "name a model whose grid is structured");
    cosim_layout_grid(layout, &c->grid);
    for (int body = 0; body < 2; body++)
        cosim_layout_output(layout, SURFACE[body], c->grid.name);
    size_t n = c->grid.points;
    return cosim_layout_cost(layout, 1e-9 * (double)(n * c->grid.ni), 8 * (2 * n + c->grid.ni));
}

static void destroy(void *user)
{
    struct columns *c = user;
    free(c->shape);
    free(c->trial);
    free(c->accepted);
}

static int build(void *user)
{
    struct columns *c = user;
    destroy(c); /* remains of the previous run */
    size_t n = c->grid.points, ni = c->grid.ni;
    c->shape = calloc(ni, sizeof *c->shape);
    c->trial = calloc(n + 2, sizeof *c->trial);
    c->accepted = calloc(n + 2, sizeof *c->accepted);
    if (!c->shape || !c->trial || !c->accepted)
        return cosim_fail("out of memory");
    double h = c->grid.step_i[0];
    for (size_t k = 0; k < ni; k++)
        c->shape[k] = sqrt(((double)k + 0.5) * h) - sqrt(fmax((double)k - 0.5, 0.0) * h);
    return COSIM_OK;
}

/* Rise of an element [K], for the fields and for the summary. */
static double rise(const struct columns *c, const double *sums, int body, size_t n)
{
    return sums[c->grid.points + body] * sums[n];
}

static int write_out(const struct columns *c, const double *sums, cosim_outputs *outputs)
{
    for (int body = 0; body < 2; body++) {
        double *values = cosim_output(outputs, SURFACE[body], NULL);
        for (size_t n = 0; values && n < c->grid.points; n++)
            values[n] = rise(c, sums, body, n);
    }
    return COSIM_OK;
}

static int solve(void *user, const cosim_step *step, const cosim_inputs *inputs,
                 cosim_outputs *outputs, cosim_report *report)
{
    (void)step;
    struct columns *c = user;
    size_t ni = c->grid.ni;
    const double *power = cosim_require_input(inputs, "friction_power", c->grid.points);
    const double *speed = cosim_require_input(inputs, "surface_speed", 2); /* upper, lower */
    if (!power || !speed)
        return COSIM_FAILED;
    for (int body = 0; body < 2; body++) {
        double own = speed[1 - body];
        if (own <= 0.0)
            return cosim_fail("material has to move through the contact: `surface_speed` > 0");
        c->trial[c->grid.points + body] = c->scale[body] / sqrt(own);
    }
    double heat = 0.0;
    for (size_t first = 0; first < c->grid.points; first += ni) {
        for (size_t i = 0; i < ni; i++) {
            double sum = 0.0;
            for (size_t k = 0; i + k < ni; k++)
                sum += power[first + i + k] * c->shape[k];
            c->trial[first + i] = sum;
            heat += power[first + i];
        }
    }
    report->substeps = 1;
    report->present = COSIM_RECEIVED_POWER;
    report->received_power = heat * c->grid.step_i[0] * c->grid.step_j[1];
    return write_out(c, c->trial, outputs);
}

static size_t state_size(const struct columns *c)
{
    return (c->grid.points + 2) * sizeof *c->accepted;
}

static int accept(void *user)
{
    struct columns *c = user;
    memcpy(c->accepted, c->trial, state_size(c));
    return COSIM_OK;
}

static int observe(void *user, cosim_outputs *outputs)
{
    struct columns *c = user;
    return write_out(c, c->accepted, outputs);
}

static int save(void *user, cosim_blob *blob)
{
    struct columns *c = user;
    return cosim_blob_write(blob, c->accepted, state_size(c));
}

static int restore(void *user, cosim_blob *blob)
{
    struct columns *c = user;
    return cosim_blob_read(blob, c->accepted, state_size(c));
}

static const char *summary(void *user)
{
    struct columns *c = user;
    double peak[2] = {0.0, 0.0};
    for (int body = 0; body < 2; body++)
        for (size_t n = 0; n < c->grid.points; n++)
            peak[body] = fmax(peak[body], rise(c, c->accepted, body, n));
    snprintf(c->summary, sizeof c->summary,
             "{\"temperature\": {\"%s\": {\"max_rise_k\": %.17g}, \"%s\": {\"max_rise_k\": %.17g}}}",
             c->name[0], peak[0], c->name[1], peak[1]);
    return c->summary;
}

int main(int argc, char **argv)
{
    struct columns c = {0};
    cosim_solver solver = {
        .size = sizeof solver, .version = COSIM_VERSION,
        .describe = describe, .configure = configure, .build = build, .solve = solve,
        .accept = accept, .observe = observe, .save = save, .restore = restore,
        .summary = summary, .destroy = destroy,
    };
    return cosim_main(argc, argv, &solver, &c);
}
