/* FMI 3.0 for co-simulation. What other kinds of FMU offer is there and says that it is not offered: an importer may
   look for every function. */
#ifdef FMI3_FUNCTION_PREFIX
#define FUNCTION_PREFIX FMI3_FUNCTION_PREFIX
#endif
#include <stdint.h>

#include "fmu.h"

enum { TIME = COUNT }; /* the number of the independent variable */

typedef uint32_t Number;
typedef void (*Logger)(void *, int, const char *, const char *);

static void say(const Instance *it, const char *what) {
    ((Logger)it->log)(it->environment, ERROR, "logStatusError", what);
}

FMI(const char *, fmi3GetVersion)(void) { return "3.0"; }

FMI(int, fmi3SetDebugLogging)(void *c, bool on, size_t n, const char *const categories[]) {
    (void)c, (void)on, (void)n, (void)categories;
    return OK;
}

FMI(void *, fmi3InstantiateCoSimulation)(const char *name, const char *token, const char *resources, bool visible,
                                         bool logging, bool events, bool early, const Number between[],
                                         size_t n_between, void *environment, Logger log, void (*update)(void)) {
    const Instance probe = {.log = (void (*)(void))log, .environment = environment};
    (void)resources, (void)visible, (void)logging, (void)events, (void)early, (void)between, (void)n_between;
    (void)update;
    return made(probe, name, token);
}

static void *other(void *environment, Logger log) {
    const Instance probe = {.log = (void (*)(void))log, .environment = environment};
    return wrong(&probe, "this is an FMU for co-simulation"), NULL;
}

FMI(void *, fmi3InstantiateModelExchange)(const char *name, const char *token, const char *resources, bool visible,
                                          bool logging, void *environment, Logger log) {
    (void)name, (void)token, (void)resources, (void)visible, (void)logging;
    return other(environment, log);
}

FMI(void *, fmi3InstantiateScheduledExecution)(const char *name, const char *token, const char *resources,
                                               bool visible, bool logging, void *environment, Logger log,
                                               void (*clock)(void), void (*lock)(void), void (*unlock)(void)) {
    (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)clock, (void)lock, (void)unlock;
    return other(environment, log);
}

FMI(void, fmi3FreeInstance)(void *c) { free(c); }

FMI(int, fmi3EnterInitializationMode)(void *c, bool tolerance_given, double tolerance, double start, bool stop_given,
                                      double stop) {
    (void)tolerance_given, (void)tolerance, (void)stop_given, (void)stop;
    ((Instance *)c)->time = start;
    ((Instance *)c)->phase = 1;
    return OK;
}

FMI(int, fmi3ExitInitializationMode)(void *c) { return begun(c); }

FMI(int, fmi3Terminate)(void *c) {
    (void)c;
    return OK;
}

FMI(int, fmi3Reset)(void *c) { return reset(c); }

static int as_many(const Instance *it, size_t n, size_t values) {
    return n == values ? OK : wrong(it, "there are as many values as variables");
}

FMI(int, fmi3GetFloat64)(void *c, const Number vr[], size_t n, double value[], size_t n_values) {
    Instance *it = c;
    int status = as_many(it, n, n_values);
    for (size_t k = 0; k < n && status == OK; k++) {
        if (vr[k] == TIME) value[k] = it->time;
        else status = get(it, vr[k], 0, &value[k]);
    }
    return status;
}

FMI(int, fmi3GetBoolean)(void *c, const Number vr[], size_t n, bool value[], size_t n_values) {
    int status = as_many(c, n, n_values);
    double one = 0.0;
    for (size_t k = 0; k < n && status == OK; k++) {
        status = get(c, vr[k], FLAG, &one);
        value[k] = one != 0.0;
    }
    return status;
}

FMI(int, fmi3SetFloat64)(void *c, const Number vr[], size_t n, const double value[], size_t n_values) {
    int status = as_many(c, n, n_values);
    for (size_t k = 0; k < n && status == OK; k++) status = set(c, vr[k], 0, value[k]);
    return status;
}

FMI(int, fmi3SetBoolean)(void *c, const Number vr[], size_t n, const bool value[], size_t n_values) {
    int status = as_many(c, n, n_values);
    for (size_t k = 0; k < n && status == OK; k++) status = set(c, vr[k], FLAG, value[k]);
    return status;
}

FMI(int, fmi3DoStep)(void *c, double time, double step, bool no_way_back, bool *event, bool *ended, bool *early,
                     double *reached) {
    Instance *it = c;
    (void)no_way_back;
    *event = *ended = *early = false;
    const int status = stepped(it, time, step);
    *reached = it->time;
    return status;
}

FMI(int, fmi3GetFMUState)(void *c, void **place) { return kept(c, place); }
FMI(int, fmi3SetFMUState)(void *c, void *place) { return back(c, place); }
FMI(int, fmi3FreeFMUState)(void *c, void **place) {
    (void)c;
    return forgotten(place);
}

/* Variables of other types: there are none. */
#define NO_VARIABLES(Type, type)                                                                     \
    FMI(int, fmi3Get##Type)(void *c, const Number vr[], size_t n, type v[], size_t n_values) {       \
        return (void)vr, (void)v, (void)n_values, none(c, n);                                        \
    }                                                                                                \
    FMI(int, fmi3Set##Type)(void *c, const Number vr[], size_t n, const type v[], size_t n_values) { \
        return (void)vr, (void)v, (void)n_values, none(c, n);                                        \
    }
NO_VARIABLES(Float32, float)
NO_VARIABLES(Int8, int8_t)
NO_VARIABLES(UInt8, uint8_t)
NO_VARIABLES(Int16, int16_t)
NO_VARIABLES(UInt16, uint16_t)
NO_VARIABLES(Int32, int32_t)
NO_VARIABLES(UInt32, uint32_t)
NO_VARIABLES(Int64, int64_t)
NO_VARIABLES(UInt64, uint64_t)

FMI(int, fmi3GetString)(void *c, const Number vr[], size_t n, const char *v[], size_t n_values) {
    return (void)vr, (void)v, (void)n_values, none(c, n);
}
FMI(int, fmi3SetString)(void *c, const Number vr[], size_t n, const char *const v[], size_t n_values) {
    return (void)vr, (void)v, (void)n_values, none(c, n);
}
FMI(int, fmi3GetBinary)(void *c, const Number vr[], size_t n, size_t sizes[], const uint8_t *v[], size_t n_values) {
    return (void)vr, (void)sizes, (void)v, (void)n_values, none(c, n);
}
FMI(int, fmi3SetBinary)(void *c, const Number vr[], size_t n, const size_t sizes[], const uint8_t *const v[],
                        size_t n_values) {
    return (void)vr, (void)sizes, (void)v, (void)n_values, none(c, n);
}
FMI(int, fmi3GetClock)(void *c, const Number vr[], size_t n, bool v[]) { return (void)vr, (void)v, none(c, n); }
FMI(int, fmi3SetClock)(void *c, const Number vr[], size_t n, const bool v[]) { return (void)vr, (void)v, none(c, n); }

/* What is not offered. */
FMI(int, fmi3EnterEventMode)(void *c) { return lacking(c); }
FMI(int, fmi3EnterStepMode)(void *c) { return lacking(c); }
FMI(int, fmi3EnterConfigurationMode)(void *c) { return lacking(c); }
FMI(int, fmi3ExitConfigurationMode)(void *c) { return lacking(c); }
FMI(int, fmi3EvaluateDiscreteStates)(void *c) { return lacking(c); }
FMI(int, fmi3EnterContinuousTimeMode)(void *c) { return lacking(c); }
FMI(int, fmi3SerializedFMUStateSize)(void *c, void *place, size_t *size) { return (void)place, (void)size, lacking(c); }
FMI(int, fmi3SerializeFMUState)(void *c, void *place, uint8_t bytes[], size_t size) {
    return (void)place, (void)bytes, (void)size, lacking(c);
}
FMI(int, fmi3DeserializeFMUState)(void *c, const uint8_t bytes[], size_t size, void **place) {
    return (void)bytes, (void)size, (void)place, lacking(c);
}
FMI(int, fmi3GetNumberOfVariableDependencies)(void *c, Number vr, size_t *n) { return (void)vr, (void)n, lacking(c); }
FMI(int, fmi3GetVariableDependencies)(void *c, Number vr, size_t elements[], Number on[], size_t its[], int kinds[],
                                      size_t n) {
    return (void)vr, (void)elements, (void)on, (void)its, (void)kinds, (void)n, lacking(c);
}
#define NO_DERIVATIVE(Name)                                                                                     \
    FMI(int, Name)(void *c, const Number of[], size_t n, const Number by[], size_t m, const double seed[],      \
                   size_t n_seed, double found[], size_t n_found) {                                             \
        (void)of, (void)n, (void)by, (void)m, (void)seed, (void)n_seed, (void)found, (void)n_found;             \
        return lacking(c);                                                                                      \
    }
NO_DERIVATIVE(fmi3GetDirectionalDerivative)
NO_DERIVATIVE(fmi3GetAdjointDerivative)
FMI(int, fmi3GetOutputDerivatives)(void *c, const Number vr[], size_t n, const int32_t orders[], double v[],
                                   size_t n_values) {
    return (void)vr, (void)n, (void)orders, (void)v, (void)n_values, lacking(c);
}
FMI(int, fmi3GetIntervalDecimal)(void *c, const Number vr[], size_t n, double v[], int kinds[]) {
    return (void)vr, (void)n, (void)v, (void)kinds, lacking(c);
}
FMI(int, fmi3SetIntervalDecimal)(void *c, const Number vr[], size_t n, const double v[]) {
    return (void)vr, (void)n, (void)v, lacking(c);
}
FMI(int, fmi3GetIntervalFraction)(void *c, const Number vr[], size_t n, uint64_t counters[], uint64_t resolutions[],
                                  int kinds[]) {
    return (void)vr, (void)n, (void)counters, (void)resolutions, (void)kinds, lacking(c);
}
FMI(int, fmi3SetIntervalFraction)(void *c, const Number vr[], size_t n, const uint64_t counters[],
                                  const uint64_t resolutions[]) {
    return (void)vr, (void)n, (void)counters, (void)resolutions, lacking(c);
}
FMI(int, fmi3GetShiftDecimal)(void *c, const Number vr[], size_t n, double v[]) {
    return (void)vr, (void)n, (void)v, lacking(c);
}
FMI(int, fmi3SetShiftDecimal)(void *c, const Number vr[], size_t n, const double v[]) {
    return (void)vr, (void)n, (void)v, lacking(c);
}
FMI(int, fmi3GetShiftFraction)(void *c, const Number vr[], size_t n, uint64_t counters[], uint64_t resolutions[]) {
    return (void)vr, (void)n, (void)counters, (void)resolutions, lacking(c);
}
FMI(int, fmi3SetShiftFraction)(void *c, const Number vr[], size_t n, const uint64_t counters[],
                               const uint64_t resolutions[]) {
    return (void)vr, (void)n, (void)counters, (void)resolutions, lacking(c);
}
FMI(int, fmi3UpdateDiscreteStates)(void *c, bool *again, bool *ended, bool *nominals, bool *values, bool *next_given,
                                   double *next) {
    (void)again, (void)ended, (void)nominals, (void)values, (void)next_given, (void)next;
    return lacking(c);
}
FMI(int, fmi3CompletedIntegratorStep)(void *c, bool no_way_back, bool *event, bool *ended) {
    return (void)no_way_back, (void)event, (void)ended, lacking(c);
}
FMI(int, fmi3SetTime)(void *c, double time) { return (void)time, lacking(c); }
FMI(int, fmi3SetContinuousStates)(void *c, const double x[], size_t n) { return (void)x, (void)n, lacking(c); }
FMI(int, fmi3GetContinuousStates)(void *c, double x[], size_t n) { return (void)x, (void)n, lacking(c); }
FMI(int, fmi3GetContinuousStateDerivatives)(void *c, double x[], size_t n) { return (void)x, (void)n, lacking(c); }
FMI(int, fmi3GetNominalsOfContinuousStates)(void *c, double x[], size_t n) { return (void)x, (void)n, lacking(c); }
FMI(int, fmi3GetEventIndicators)(void *c, double z[], size_t n) { return (void)z, (void)n, lacking(c); }
FMI(int, fmi3GetNumberOfEventIndicators)(void *c, size_t *n) { return (void)n, lacking(c); }
FMI(int, fmi3GetNumberOfContinuousStates)(void *c, size_t *n) { return (void)n, lacking(c); }
FMI(int, fmi3ActivateModelPartition)(void *c, Number clock, double time) { return (void)clock, (void)time, lacking(c); }
