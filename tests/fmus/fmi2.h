/* The functions of FMI 2.0 for co-simulation that these FMUs need, over an array of values (model.h). */
#include "model.h"

typedef struct {
    void (*log)(void *environment, const char *name, int status, const char *category, const char *message, ...);
    void *(*allocate)(size_t count, size_t size);
    void (*free)(void *memory);
    void (*finished)(void *environment, int status);
    void *environment;
} Callbacks;

typedef struct {
    double values[COUNT];
    const Callbacks *host;
} Instance;

static int complain(Instance *of, const char *what, double value) {
    of->host->log(of->host->environment, "an instance", STATUS_ERROR, "logStatusError", "%s: %g", what, value);
    return STATUS_ERROR;
}

const char *fmi2GetTypesPlatform(void) { return "default"; }
const char *fmi2GetVersion(void) { return "2.0"; }

int fmi2SetDebugLogging(void *of, int on, size_t count, const char *const *categories) {
    (void)of, (void)on, (void)count, (void)categories;
    return STATUS_OK;
}

void *fmi2Instantiate(const char *name, int type, const char *token, const char *resources, const Callbacks *host,
                      int visible, int logging) {
    (void)name, (void)resources, (void)visible, (void)logging;
    Instance *of = host->allocate(1, sizeof *of);
    of->host = host;
    memcpy(of->values, START, sizeof START);
    if (strcmp(token, TOKEN) != 0 || type != 1) {
        complain(of, "another token, or no co-simulation", type);
        host->free(of);
        return NULL;
    }
    return of;
}

void fmi2FreeInstance(void *of) {
    if (of) ((Instance *)of)->host->free(of);
}

int fmi2SetupExperiment(void *of, int has_tolerance, double tolerance, double start, int has_stop, double stop) {
    (void)of, (void)has_tolerance, (void)tolerance, (void)start, (void)has_stop, (void)stop;
#ifdef EXPERIMENT
    double *values = ((Instance *)of)->values;
    if (has_tolerance) values[TOLERANCE] = tolerance;
    if (has_stop) values[STOP] = stop;
#endif
    return STATUS_OK;
}

int fmi2EnterInitializationMode(void *of) { return (void)of, STATUS_OK; }

int fmi2ExitInitializationMode(void *of) {
    Instance *instance = of;
    return advance(instance->values, 0.0, 0.0);
}

int fmi2Terminate(void *of) { return (void)of, STATUS_OK; }

int fmi2Reset(void *of) {
    memcpy(((Instance *)of)->values, START, sizeof START);
    return STATUS_OK;
}

int fmi2GetReal(void *of, const uint32_t *references, size_t count, double *values) {
    for (size_t n = 0, first; n < count; ++n) {
        if (locate(references[n], &first) != 1) return complain(of, "there is no variable", references[n]);
        values[n] = ((Instance *)of)->values[first];
    }
    return STATUS_OK;
}

int fmi2SetReal(void *of, const uint32_t *references, size_t count, const double *values) {
    for (size_t n = 0, first; n < count; ++n) {
        if (locate(references[n], &first) != 1) return complain(of, "there is no variable", references[n]);
        ((Instance *)of)->values[first] = values[n];
    }
    return STATUS_OK;
}

int fmi2GetInteger(void *of, const uint32_t *references, size_t count, int *values) {
    for (size_t n = 0, first; n < count; ++n) {
        if (locate(references[n], &first) != 1) return complain(of, "there is no variable", references[n]);
        values[n] = (int)((Instance *)of)->values[first];
    }
    return STATUS_OK;
}

int fmi2SetInteger(void *of, const uint32_t *references, size_t count, const int *values) {
    for (size_t n = 0, first; n < count; ++n) {
        if (locate(references[n], &first) != 1) return complain(of, "there is no variable", references[n]);
        ((Instance *)of)->values[first] = values[n];
    }
    return STATUS_OK;
}

int fmi2GetBoolean(void *of, const uint32_t *references, size_t count, int *values) {
    return fmi2GetInteger(of, references, count, values);
}

int fmi2SetBoolean(void *of, const uint32_t *references, size_t count, const int *values) {
    return fmi2SetInteger(of, references, count, values);
}

int fmi2DoStep(void *of, double time, double length, int no_return) {
    (void)no_return;
    int status = advance(((Instance *)of)->values, time, length);
    if (status > STATUS_WARNING) complain(of, "no step from", time);
    return status;
}

int fmi2GetFMUstate(void *of, void **state) {
    if (!*state) *state = malloc(sizeof START);
    memcpy(*state, ((Instance *)of)->values, sizeof START);
    return STATUS_OK;
}

int fmi2SetFMUstate(void *of, void *state) {
    memcpy(((Instance *)of)->values, state, sizeof START);
    return STATUS_OK;
}

int fmi2FreeFMUstate(void *of, void **state) {
    (void)of;
    free(*state);
    *state = NULL;
    return STATUS_OK;
}

int fmi2SerializedFMUstateSize(void *of, void *state, size_t *size) {
    (void)of, (void)state;
    *size = sizeof START;
    return STATUS_OK;
}

int fmi2SerializeFMUstate(void *of, void *state, char *bytes, size_t size) {
    if (size != sizeof START) return complain(of, "a state of another size", size);
    memcpy(bytes, state, size);
    return STATUS_OK;
}

int fmi2DeSerializeFMUstate(void *of, const char *bytes, size_t size, void **state) {
    if (size != sizeof START) return complain(of, "a state of another size", size);
    *state = malloc(size);
    memcpy(*state, bytes, size);
    return STATUS_OK;
}

/* What the standard has besides: there, and not supported. */
#define ABSENT(name) \
    int name(void) { return STATUS_ERROR; }
ABSENT(fmi2CancelStep) ABSENT(fmi2CompletedIntegratorStep) ABSENT(fmi2EnterContinuousTimeMode)
ABSENT(fmi2EnterEventMode) ABSENT(fmi2GetBooleanStatus) ABSENT(fmi2GetContinuousStates) ABSENT(fmi2GetDerivatives)
ABSENT(fmi2GetDirectionalDerivative) ABSENT(fmi2GetEventIndicators) ABSENT(fmi2GetIntegerStatus)
ABSENT(fmi2GetNominalsOfContinuousStates) ABSENT(fmi2GetRealOutputDerivatives) ABSENT(fmi2GetRealStatus)
ABSENT(fmi2GetStatus) ABSENT(fmi2GetString) ABSENT(fmi2GetStringStatus) ABSENT(fmi2NewDiscreteStates)
ABSENT(fmi2SetContinuousStates) ABSENT(fmi2SetRealInputDerivatives) ABSENT(fmi2SetString) ABSENT(fmi2SetTime)
