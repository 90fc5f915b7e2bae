/* The functions of FMI 3.0 for co-simulation that these FMUs need, over an array of values (model.h). */
#include "model.h"

typedef void (*Log)(void *environment, int status, const char *category, const char *message);

typedef struct {
    double values[COUNT];
    void *environment;
    Log log;
} Instance;

static int complain(Instance *of, const char *message) {
    if (of->log) of->log(of->environment, STATUS_ERROR, "logStatusError", message);
    return STATUS_ERROR;
}

const char *fmi3GetVersion(void) { return "3.0"; }

int fmi3SetDebugLogging(void *of, bool on, size_t count, const char *const *categories) {
    (void)of, (void)on, (void)count, (void)categories;
    return STATUS_OK;
}

void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *resources, bool visible, bool logging,
                                  bool events, bool early, const uint32_t *intermediate, size_t count, void *environment,
                                  Log log, void *update) {
    (void)name, (void)resources, (void)visible, (void)logging, (void)intermediate, (void)count, (void)update;
    Instance *of = calloc(1, sizeof *of);
    of->environment = environment;
    of->log = log;
    memcpy(of->values, START, sizeof START);
    if (strcmp(token, TOKEN) != 0 || events || early) {
        complain(of, "another token, or modes that there are not");
        free(of);
        return NULL;
    }
    return of;
}

void fmi3FreeInstance(void *of) { free(of); }

int fmi3EnterInitializationMode(void *of, bool has_tolerance, double tolerance, double start, bool has_stop, double stop) {
    (void)of, (void)has_tolerance, (void)tolerance, (void)start, (void)has_stop, (void)stop;
    return STATUS_OK;
}

int fmi3ExitInitializationMode(void *of) {
    Instance *instance = of;
    return advance(instance->values, 0.0, 0.0);
}

int fmi3Terminate(void *of) { return (void)of, STATUS_OK; }

int fmi3Reset(void *of) {
    memcpy(((Instance *)of)->values, START, sizeof START);
    return STATUS_OK;
}

static int pass(Instance *of, const uint32_t *references, size_t count, double *values, size_t length, bool into) {
    size_t done = 0;
    for (size_t n = 0; n < count; ++n) {
        size_t first, size = locate(references[n], &first);
        if (size == 0 || done + size > length) return complain(of, "there is no such variable, or it has another size");
        if (into)
            memcpy(of->values + first, values + done, size * sizeof *values);
        else
            memcpy(values + done, of->values + first, size * sizeof *values);
        done += size;
    }
    return done == length ? STATUS_OK : complain(of, "more values than the variables have");
}

int fmi3GetFloat64(void *of, const uint32_t *references, size_t count, double *values, size_t length) {
    return pass(of, references, count, values, length, false);
}

int fmi3SetFloat64(void *of, const uint32_t *references, size_t count, const double *values, size_t length) {
    return pass(of, references, count, (double *)values, length, true);
}

int fmi3DoStep(void *of, double time, double length, bool no_return, bool *event, bool *terminate, bool *early,
               double *last) {
    (void)no_return;
    *event = *terminate = *early = false;
    *last = time + length;
    return advance(((Instance *)of)->values, time, length);
}

int fmi3GetFMUState(void *of, void **state) {
    if (!*state) *state = malloc(sizeof START);
    memcpy(*state, ((Instance *)of)->values, sizeof START);
    return STATUS_OK;
}

int fmi3SetFMUState(void *of, void *state) {
    memcpy(((Instance *)of)->values, state, sizeof START);
    return STATUS_OK;
}

int fmi3FreeFMUState(void *of, void **state) {
    (void)of;
    free(*state);
    *state = NULL;
    return STATUS_OK;
}

int fmi3SerializedFMUStateSize(void *of, void *state, size_t *size) {
    (void)of, (void)state;
    *size = sizeof START;
    return STATUS_OK;
}

int fmi3SerializeFMUState(void *of, void *state, uint8_t *bytes, size_t size) {
    if (size != sizeof START) return complain(of, "a state of another size");
    memcpy(bytes, state, size);
    return STATUS_OK;
}

int fmi3DeserializeFMUState(void *of, const uint8_t *bytes, size_t size, void **state) {
    if (size != sizeof START) return complain(of, "a state of another size");
    *state = malloc(size);
    memcpy(*state, bytes, size);
    return STATUS_OK;
}

/* What the standard has besides: there, and not supported. */
#define ABSENT(name) \
    int name(void) { return STATUS_ERROR; }
ABSENT(fmi3ActivateModelPartition) ABSENT(fmi3CompletedIntegratorStep) ABSENT(fmi3EnterConfigurationMode)
ABSENT(fmi3EnterContinuousTimeMode) ABSENT(fmi3EnterEventMode) ABSENT(fmi3EnterStepMode)
ABSENT(fmi3EvaluateDiscreteStates) ABSENT(fmi3ExitConfigurationMode) ABSENT(fmi3GetAdjointDerivative)
ABSENT(fmi3GetBinary) ABSENT(fmi3GetBoolean) ABSENT(fmi3GetClock) ABSENT(fmi3GetContinuousStateDerivatives)
ABSENT(fmi3GetContinuousStates) ABSENT(fmi3GetDirectionalDerivative) ABSENT(fmi3GetEventIndicators)
ABSENT(fmi3GetFloat32) ABSENT(fmi3GetInt16) ABSENT(fmi3GetInt32) ABSENT(fmi3GetInt64) ABSENT(fmi3GetInt8)
ABSENT(fmi3GetIntervalDecimal) ABSENT(fmi3GetIntervalFraction) ABSENT(fmi3GetNominalsOfContinuousStates)
ABSENT(fmi3GetNumberOfContinuousStates) ABSENT(fmi3GetNumberOfEventIndicators)
ABSENT(fmi3GetNumberOfVariableDependencies) ABSENT(fmi3GetOutputDerivatives) ABSENT(fmi3GetShiftDecimal)
ABSENT(fmi3GetShiftFraction) ABSENT(fmi3GetString) ABSENT(fmi3GetUInt16) ABSENT(fmi3GetUInt32) ABSENT(fmi3GetUInt64)
ABSENT(fmi3GetUInt8) ABSENT(fmi3GetVariableDependencies) ABSENT(fmi3SetBinary) ABSENT(fmi3SetBoolean)
ABSENT(fmi3SetClock) ABSENT(fmi3SetContinuousStates) ABSENT(fmi3SetFloat32) ABSENT(fmi3SetInt16)
ABSENT(fmi3SetInt32) ABSENT(fmi3SetInt64) ABSENT(fmi3SetInt8) ABSENT(fmi3SetIntervalDecimal)
ABSENT(fmi3SetIntervalFraction) ABSENT(fmi3SetShiftDecimal) ABSENT(fmi3SetShiftFraction) ABSENT(fmi3SetString)
ABSENT(fmi3SetTime) ABSENT(fmi3SetUInt16) ABSENT(fmi3SetUInt32) ABSENT(fmi3SetUInt64) ABSENT(fmi3SetUInt8)
ABSENT(fmi3UpdateDiscreteStates)

void *fmi3InstantiateModelExchange(void) { return NULL; }
void *fmi3InstantiateScheduledExecution(void) { return NULL; }
