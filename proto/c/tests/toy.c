/*
 * A stateful participant for the system tests, in the role `right` of cases/exchange.toml. It keeps
 * a sum that depends on all data received so far, and misbehaves on request.
 */
#define _POSIX_C_SOURCE 199309L
#include <cosim.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static const char *const DESCRIPTION = COSIM_JSON({
    "name": "toy", "version": "1", "role": "right", "standalone": true,
    "models": [{"name": "increment", "summary": "a running sum", "source": "counting",
                "steady": true, "transient": true,
                "consumes": ["left_value"], "provides": ["right_value"]}],
    "keys": [
        {"path": "right.points", "type": "integer", "default": 1000, "help": "size of the field"},
        {"path": "right.fault", "type": "text", "default": "none", "help": "way to misbehave"}
    ],
    "fields": [
        {"name": "left_value", "unit": "1", "components": 1, "mapping": "consistent",
         "body": "interface", "meaning": "a number"},
        {"name": "right_value", "unit": "1", "components": 1, "mapping": "consistent",
         "body": "interface", "meaning": "a number"}
    ]
});

struct toy {
    char fault[32];
    cosim_grid grid;
    double trial, accepted;
    char summary[100];
};

static int fail_if(const struct toy *toy, const char *fault)
{
    return strcmp(toy->fault, fault) == 0 ? cosim_fail("told to fail") : COSIM_OK;
}

static const char *describe(void *user)
{
    (void)user;
    return DESCRIPTION;
}

static const char *describe_badly(void *user)
{
    (void)user;
    return "{\"name\": toy}";
}

static int configure(void *user, const cosim_configuration *told, cosim_layout *layout)
{
    struct toy *toy = user;
    int64_t points;
    const char *fault = cosim_case_text(told, "right.fault");
    if (!fault || cosim_case_integer(told, "right.points", &points))
        return COSIM_REFUSED;
    snprintf(toy->fault, sizeof toy->fault, "%s", fault);
    if (strcmp(fault, "refuse") == 0)
        return cosim_refuse("right.fault", "is a word too many", "write something else");
    if (strcmp(fault, "missing") == 0)
        return cosim_case_number(told, "right.depth", &toy->trial);
    if (fail_if(toy, "configure"))
        return COSIM_FAILED;
    toy->grid = (cosim_grid){.name = "numbers", .kind = COSIM_STRUCTURED, .ni = (size_t)points,
                             .nj = 1, .step_i = {1.0, 0.0, 0.0}, .step_j = {0.0, 1.0, 0.0}};
    return cosim_layout_grid(layout, &toy->grid) ||
           cosim_layout_output(layout, "right_value", "numbers");
}

static int build(void *user)
{
    return fail_if(user, "build");
}

/* Works for three seconds in a solve. With `stuck`, progress reports stop after one second. */
static void work_long(const struct toy *toy)
{
    int stuck = strcmp(toy->fault, "stuck") == 0;
    if (!stuck && strcmp(toy->fault, "long") != 0)
        return;
    for (uint64_t done = 0; done < 30; done++) {
        if (!stuck || done <= 10)
            cosim_progress(done, 30, "sweeping");
        nanosleep(&(struct timespec){.tv_nsec = 100000000}, NULL);
    }
}

static int solve(void *user, const cosim_step *step, const cosim_inputs *inputs,
                 cosim_outputs *outputs, cosim_report *report)
{
    struct toy *toy = user;
    size_t count;
    const double *received = cosim_require_input(inputs, "left_value", toy->grid.ni);
    double *sent = cosim_output(outputs, "right_value", &count);
    if (!received || !sent)
        return COSIM_FAILED;
    toy->trial = 0.7 * toy->accepted + sin(received[0]) + (step->end - step->start) / 3.0;
    if (step->window == 3)
        work_long(toy);
    if (step->window == 3 && strcmp(toy->fault, "unwritten") == 0)
        return COSIM_OK;
    for (size_t i = 0; i < count; i++)
        sent[i] = received[i] + toy->trial;
    report->substeps = 1;
    if (step->window != 3)
        return COSIM_OK;
    if (strcmp(toy->fault, "silent") == 0)
        return 5;
    if (strcmp(toy->fault, "misuse") == 0)
        cosim_output(NULL, "right_value", NULL);
    return fail_if(toy, "solve");
}

static int accept(void *user)
{
    struct toy *toy = user;
    toy->accepted = toy->trial;
    return fail_if(toy, "accept");
}

static int save(void *user, cosim_blob *blob)
{
    struct toy *toy = user;
    return cosim_blob_write(blob, &toy->accepted, sizeof toy->accepted);
}

static int restore(void *user, cosim_blob *blob)
{
    struct toy *toy = user;
    return cosim_blob_read(blob, &toy->accepted, sizeof toy->accepted);
}

static const char *summary(void *user)
{
    struct toy *toy = user;
    if (fail_if(toy, "summary"))
        return NULL;
    snprintf(toy->summary, sizeof toy->summary, "{\"right\": {\"sum\": %.17g}}", toy->accepted);
    return toy->summary;
}

int main(int argc, char **argv)
{
    struct toy toy = {0};
    cosim_solver solver = {
        .size = sizeof solver, .version = COSIM_VERSION,
        .describe = describe, .configure = configure, .build = build, .solve = solve,
        .accept = accept, .save = save, .restore = restore, .summary = summary,
    };
    /* A word before the options selects a fault of the table. */
    const char *word = argc > 1 && argv[1][0] != '-' ? argv[1] : "";
    if (strcmp(word, "no-solve") == 0)
        solver.solve = NULL;
    if (strcmp(word, "old") == 0)
        solver.version = 0;
    if (strcmp(word, "bad-json") == 0)
        solver.describe = describe_badly;
    if (*word)
        return cosim_main(argc - 1, argv + 1, &solver, &toy);
    return cosim_main(argc, argv, &solver, &toy);
}
