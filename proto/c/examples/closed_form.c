/*
 * Flash temperature of two bodies in closed form: a thermal solver in C with the same results as
 * the model `ertz-knothe` of thermal-solver (Naeimi et al., equations 9 to 12, corrected; Ertz &
 * Knothe, Wear 253 (2002) 498-508).
 *
 * Each row of the friction power along x is replaced by the ellipse with the same moments: heat Q,
 * centre x_c, semi-axis a and amplitude q_0,
 *
 *     Q = int q dx,  x_c = int x q dx / Q,  a = 2 sqrt(int (x - x_c)^2 q dx / Q),
 *     q_0 = 2 Q / (pi a).
 *
 * Material passes at the surface speed V, from the leading edge (large x) towards -x, and conducts
 * heat only normal to the surface. With the share eps of the heat and the effusivity
 * beta = sqrt(lambda rho c), the temperature rise of the surface is
 *
 *     T(x) = eps q_0 / beta sqrt(a / (pi V)) F(xi),  xi = (x_c - x) / a,
 *
 * where F belongs to the polynomial pi/2048 (645 - 210 xi^2 - 315 xi^4), which has the moments of
 * the ellipse sqrt(1 - xi^2): see rise_shape().
 */
#include <cosim.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { UPPER = COSIM_UPPER, LOWER = COSIM_LOWER, BODIES };

static const double PI = 3.14159265358979323846;

static const char *const SURFACE[BODIES] = {"upper_temperature", "lower_temperature"};

static const char *const DESCRIPTION = COSIM_JSON({
    "name": "closed-form", "version": "1.0", "role": "thermal", "reusable": true,
    "models": [{
        "name": "ertz-knothe", "steady": true, "transient": false,
        "summary": "closed form for the elliptic flux with the moments of each row, in C",
        "source": "Naeimi et al., eqs. 9-12; Ertz & Knothe, Wear 253 (2002) 498-508",
        "consumes": ["friction_power", "surface_speed"],
        "provides": ["lower_temperature", "upper_temperature"]
    }],
    "effects": [{
        "name": "friction_heat", "models": ["ertz-knothe"],
        "law": "q_upper = eps q_f, q_lower = (1 - eps) q_f",
        "source": "Naeimi et al., eqs. 7-10; Ertz & Knothe, Wear 253 (2002) 498-508",
        "consumes": ["friction_power", "surface_speed"],
        "provides": ["lower_temperature", "upper_temperature"],
        "keys": [{"path": "effects.friction_heat.partition", "type": "choice",
                  "of": ["equal", "effusivity"], "default": "equal",
                  "help": "how the heat is split between the bodies"}]
    }],
    "keys": [
        {"path": "bodies.*.position", "type": "choice", "of": ["upper", "lower"], "required": true,
         "help": "which of the two bodies it is"},
        {"path": "bodies.*.material", "type": "name-in", "table": "materials", "required": true,
         "help": "material of the body"},
        {"path": "materials.*.density", "type": "quantity", "unit": "kg/m3", "required": true,
         "above": 0, "help": "mass per volume"},
        {"path": "materials.*.specific_heat", "type": "quantity", "unit": "J/(kg K)",
         "required": true, "above": 0, "help": "heat per mass and temperature"},
        {"path": "materials.*.conductivity", "type": "quantity", "unit": "W/(m K)",
         "required": true, "above": 0, "help": "heat flux per temperature gradient"}
    ],
    "figures": [
        {"key": "temperature.*.max_rise_k", "unit": "K", "words": "temperature rise", "line": "*",
         "style": "signed", "headline": true, "rank": 1,
         "driven_by": "contact.friction_power_w"},
        {"key": "temperature.*.x_over_a", "unit": "1", "words": "place x/a", "line": "*",
         "short": "at x/a", "digits": 4, "measure": "absolute", "rank": 2,
         "derived": {"ratio": {"of": ["temperature.*.x_m"], "over": "contact.semi_axis_a_m"}}},
        {"key": "temperature.*.x_m", "unit": "m", "words": "place x", "style": "place",
         "measure": "absolute"},
        {"key": "temperature.*.y_m", "unit": "m", "words": "place y", "line": "*", "short": "y",
         "style": "place", "measure": "absolute"}
    ]
});

/* Ellipse that replaces a row. */
struct ellipse {
    double heat;      /* Q [W/m] */
    double centre;    /* x_c [m] */
    double semi_axis; /* a [m]; 0 where there is no heat */
};

/* Result of a solve, from which the temperature field follows. */
struct field {
    double speed[BODIES]; /* V [m/s] */
    double share[BODIES]; /* eps [-] */
    struct ellipse row[]; /* one per row */
};

struct closed_form {
    cosim_grid grid;           /* of the heat and of both temperatures */
    bool by_effusivity;        /* the law of partition */
    double effusivity[BODIES]; /* beta [J/(m2 K sqrt(s))] */
    struct field *trial, *accepted;
    char name[BODIES][32];     /* of the bodies in the case */
    char summary[640];
};

static size_t field_size(const struct closed_form *cf)
{
    return sizeof(struct field) + cf->grid.nj * sizeof(struct ellipse);
}

/* F(xi). Behind the contact, F is a difference of two roots. Far behind, where the roots nearly
 * cancel, the difference of their squares is divided by their sum; powers above xi^4 cancel. */
static double rise_shape(double xi)
{
    if (xi <= -1.0)
        return 0.0;
    double even = 71.0 - xi * xi * (20.0 + 16.0 * xi * xi);
    double odd = xi * (12.0 + 8.0 * xi * xi);
    double front = sqrt(xi + 1.0) * (even + odd);
    if (xi <= 1.0)
        return PI / 128.0 * front;
    double back = sqrt(xi - 1.0) * (even - odd);
    if (xi < 2.0)
        return PI / 128.0 * (front - back);
    double squares = 10082.0 - xi * xi * (1984.0 + 2048.0 * xi * xi);
    return PI / 128.0 * squares / (front + back);
}

/* xi where F is largest, 0.647: the root of dF/dxi, by Newton's method. */
static double hottest_place(void)
{
    double xi = 0.65;
    for (int i = 0; i < 6; i++) {
        double value = 47.5 - xi * (22.0 + xi * (26.0 + xi * (36.0 + 72.0 * xi)));
        double slope = -22.0 - xi * (52.0 + xi * (108.0 + 288.0 * xi));
        xi -= value / slope;
    }
    return xi;
}

static double limited(double value, double left, double right)
{
    if (left * right <= 0.0)
        return 0.0;
    double most = 3.0 * fmin(fabs(left), fabs(right));
    return copysign(fmin(fmax(copysign(1.0, left) * value, 0.0), most), left);
}

/* Flux at the edge before element i of a row with n element means, from the cubic through the four
 * surrounding means, or a parabola near an end. The value is limited to between 0 and three times
 * the smaller adjacent mean. Material enters at the end of the row, where the flux is zero. */
static double edge(const double *q, size_t n, size_t i)
{
    if (i == n)
        return 0.0;
    if (i >= 2 && i + 2 <= n)
        return limited((7.0 * (q[i - 1] + q[i]) - q[i - 2] - q[i + 1]) / 12.0, q[i - 1], q[i]);
    if (i == 0)
        return limited((11.0 * q[0] - 7.0 * q[1] + 2.0 * q[2]) / 6.0, q[0], q[0]);
    if (i == 1)
        return limited((2.0 * q[0] + 5.0 * q[1] - q[2]) / 6.0, q[0], q[1]);
    return limited((2.0 * q[n - 1] + 5.0 * q[n - 2] - q[n - 3]) / 6.0, q[n - 2], q[n - 1]);
}

/* Fits the ellipse of a row of n element means. The moments about the row's middle element use a
 * parabola in each element with the edge values l, r and the mean. Returns false if none fits. */
static bool fit(const cosim_grid *grid, const double *q, struct ellipse *ellipse)
{
    size_t n = grid->ni, middle = n / 2;
    double h = grid->step_i[0], m0 = 0.0, m1 = 0.0, m2 = 0.0;
    *ellipse = (struct ellipse){0.0, 0.0, 0.0};
    double l = edge(q, n, 0);
    bool warm = false;
    for (size_t i = 0; i < n; i++) {
        double r = edge(q, n, i + 1), way = (double)i - (double)middle;
        if (q[i] != 0.0) {
            double first = 0.5 * q[i] + (r - l) / 12.0, second = 0.3 * q[i] - l / 15.0 + r / 10.0;
            m0 += q[i];
            m1 += first + way * q[i];
            m2 += second + way * (2.0 * first + way * q[i]);
            warm = true;
        }
        l = r;
    }
    if (!warm)
        return true;
    double mean = m1 / m0, variance = m2 / m0 - mean * mean;
    ellipse->heat = h * m0;
    ellipse->centre = grid->origin[0] + h * ((double)middle + mean - 0.5);
    ellipse->semi_axis = 2.0 * h * sqrt(variance);
    return variance > 0.0;
}

/* eps q_0/beta sqrt(a/(pi V)) of a row [K]. */
static double amplitude(const struct closed_form *cf, const struct field *field, int body,
                        size_t row)
{
    const struct ellipse *e = &field->row[row];
    double flux = field->share[body] * 2.0 * e->heat / (PI * e->semi_axis);
    return flux / cf->effusivity[body] * sqrt(e->semi_axis / (PI * field->speed[body]));
}

/* Writes the requested surface temperatures of a field. */
static void write_surfaces(const struct closed_form *cf, const struct field *field,
                           cosim_outputs *outputs)
{
    double *lower = cosim_output(outputs, SURFACE[LOWER], NULL);
    double *upper = cosim_output(outputs, SURFACE[UPPER], NULL);
    for (size_t j = 0; j < cf->grid.nj; j++) {
        const struct ellipse *e = &field->row[j];
        bool warm = e->semi_axis > 0.0;
        double of_lower = warm ? amplitude(cf, field, LOWER, j) : 0.0;
        double of_upper = warm ? amplitude(cf, field, UPPER, j) : 0.0;
        for (size_t i = 0, n = j * cf->grid.ni; i < cf->grid.ni; i++, n++) {
            double x = cf->grid.origin[0] + (double)i * cf->grid.step_i[0];
            double shape = warm ? rise_shape((e->centre - x) / e->semi_axis) : 0.0;
            if (lower)
                lower[n] = of_lower * shape;
            if (upper)
                upper[n] = of_upper * shape;
        }
    }
}

static const char *describe(void *user)
{
    (void)user;
    return DESCRIPTION;
}

static int read_effusivity(const cosim_configuration *told, const char *body, double *effusivity)
{
    static const char *const PROPERTY[] = {"density", "specific_heat", "conductivity"};
    char key[256];
    snprintf(key, sizeof key, "bodies.%s.material", body);
    const char *material = cosim_case_text(told, key);
    if (!material)
        return COSIM_REFUSED;
    double product = 1.0;
    for (int p = 0; p < 3; p++) {
        double value;
        snprintf(key, sizeof key, "materials.%s.%s", material, PROPERTY[p]);
        if (cosim_case_number(told, key, &value))
            return COSIM_REFUSED;
        if (value <= 0.0)
            return cosim_refuse(key, "is not greater than 0", "write a positive number");
        product *= value;
    }
    *effusivity = sqrt(product);
    return COSIM_OK;
}

static bool is_contact_plane(const cosim_grid *grid)
{
    return grid->kind == COSIM_STRUCTURED && grid->ni >= 4 && grid->step_i[0] > 0.0 &&
           grid->step_i[1] == 0.0 && grid->step_i[2] == 0.0 && grid->step_j[0] == 0.0 &&
           grid->step_j[1] > 0.0 && grid->step_j[2] == 0.0;
}

static int configure(void *user, const cosim_configuration *told, cosim_layout *layout)
{
    struct closed_form *cf = user;
    if (cosim_is_transient(told))
        return cosim_refuse("time.mode", "the closed form is steady", "write mode = \"steady\"");
    if (!cosim_has_effect(told, "friction_heat"))
        return cosim_refuse("effects.friction_heat", "no other effect gives any heat",
                            "add the table `[effects.friction_heat]`");
    for (int body = 0; body < BODIES; body++) {
        const char *name = cosim_body_name(told, body);
        if (!name || read_effusivity(told, name, &cf->effusivity[body]))
            return COSIM_REFUSED;
        snprintf(cf->name[body], sizeof cf->name[body], "%s", name);
    }
    const char *partition = cosim_case_text(told, "effects.friction_heat.partition");
    if (!partition)
        return COSIM_REFUSED;
    cf->by_effusivity = strcmp(partition, "effusivity") == 0;
    if (!cosim_input_grid(told, "friction_power", &cf->grid))
        return cosim_layout_remark(layout, "grid and cost follow the grid of friction_power");
    if (!is_contact_plane(&cf->grid))
        return cosim_refuse("mech.model", "its grid has no rows of four elements along x",
                            "name a model with such a grid");
    strcpy(cf->grid.name, "contact");
    cf->grid.revision = 1;
    cosim_layout_grid(layout, &cf->grid);
    for (int body = 0; body < BODIES; body++)
        cosim_layout_output(layout, SURFACE[body], "contact");
    return cosim_layout_cost(layout, 30e-9 * (double)cf->grid.points, 2 * field_size(cf));
}

static void destroy(void *user)
{
    struct closed_form *cf = user;
    free(cf->trial);
    free(cf->accepted);
}

static int build(void *user)
{
    struct closed_form *cf = user;
    destroy(cf); /* remains of the previous run */
    cf->trial = calloc(1, field_size(cf));
    cf->accepted = calloc(1, field_size(cf));
    return cf->trial && cf->accepted ? COSIM_OK : cosim_fail("out of memory");
}

static int solve(void *user, const cosim_step *step, const cosim_inputs *inputs,
                 cosim_outputs *outputs, cosim_report *report)
{
    (void)step;
    struct closed_form *cf = user;
    struct field *field = cf->trial;
    const double *speed = cosim_require_input(inputs, "surface_speed", BODIES);
    const double *power = cosim_require_input(inputs, "friction_power", cf->grid.points);
    if (!speed || !power)
        return COSIM_FAILED;
    double uptake[BODIES], heat = 0.0;
    for (int body = 0; body < BODIES; body++) {
        if (speed[body] <= 0.0)
            return cosim_fail("material has to move through the contact: `surface_speed` > 0");
        field->speed[body] = speed[body];
        uptake[body] = cf->by_effusivity ? cf->effusivity[body] * sqrt(speed[body]) : 1.0;
    }
    for (int body = 0; body < BODIES; body++)
        field->share[body] = uptake[body] / (uptake[UPPER] + uptake[LOWER]);
    for (size_t j = 0; j < cf->grid.nj; j++) {
        if (!fit(&cf->grid, power + j * cf->grid.ni, &field->row[j]))
            return cosim_fail("the heat flux of a row changes its sign and is not representable by an ellipse");
        heat += field->row[j].heat;
        report->work += field->row[j].semi_axis > 0.0 ? cf->grid.ni : 0;
    }
    write_surfaces(cf, field, outputs);
    report->substeps = 1;
    report->present = COSIM_RECEIVED_POWER;
    report->received_power = heat * cf->grid.step_j[1];
    return COSIM_OK;
}

static int accept(void *user)
{
    struct closed_form *cf = user;
    memcpy(cf->accepted, cf->trial, field_size(cf));
    return COSIM_OK;
}

static int observe(void *user, cosim_outputs *outputs)
{
    struct closed_form *cf = user;
    write_surfaces(cf, cf->accepted, outputs);
    return COSIM_OK;
}

static int save(void *user, cosim_blob *blob)
{
    struct closed_form *cf = user;
    return cosim_blob_write(blob, cf->accepted, field_size(cf));
}

static int restore(void *user, cosim_blob *blob)
{
    struct closed_form *cf = user;
    return cosim_blob_read(blob, cf->accepted, field_size(cf));
}

/* Hottest place of each body, possibly between element centres. */
static const char *summary(void *user)
{
    struct closed_form *cf = user;
    const struct field *field = cf->accepted;
    double rise[BODIES] = {0.0, 0.0}, x = 0.0, y = 0.0, xi = hottest_place();
    for (size_t j = 0; j < cf->grid.nj; j++) {
        const struct ellipse *e = &field->row[j];
        if (e->semi_axis == 0.0 || amplitude(cf, field, LOWER, j) * rise_shape(xi) <= rise[LOWER])
            continue;
        for (int body = 0; body < BODIES; body++)
            rise[body] = amplitude(cf, field, body, j) * rise_shape(xi);
        x = e->centre - xi * e->semi_axis;
        y = cf->grid.origin[1] + (double)j * cf->grid.step_j[1];
    }
    char part[BODIES][200];
    for (int body = 0; body < BODIES; body++)
        snprintf(part[body], sizeof part[body],
                 rise[LOWER] > 0.0 ? "{\"max_rise_k\": %.17g, \"x_m\": %.17g, \"y_m\": %.17g}"
                                  : "{\"max_rise_k\": %.17g}", rise[body], x, y);
    snprintf(cf->summary, sizeof cf->summary, "{\"temperature\": {\"%s\": %s, \"%s\": %s}}",
             cf->name[LOWER], part[LOWER], cf->name[UPPER], part[UPPER]);
    return cf->summary;
}

int main(int argc, char **argv)
{
    struct closed_form cf = {0};
    cosim_solver solver = {
        .size = sizeof solver, .version = COSIM_VERSION,
        .describe = describe, .configure = configure, .build = build, .solve = solve,
        .accept = accept, .observe = observe, .save = save, .restore = restore,
        .summary = summary, .destroy = destroy,
    };
    return cosim_main(argc, argv, &solver, &cf);
}
