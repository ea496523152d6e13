/* FMI 2.0 for co-simulation. */
#ifdef FMI2_FUNCTION_PREFIX
#define FUNCTION_PREFIX FMI2_FUNCTION_PREFIX
#endif
#include "fmu.h"

typedef void (*Logger)(void *, const char *, int, const char *, const char *, ...);

typedef struct {
    Logger logger;
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*finished)(void *, int);
    void *environment;
} Callbacks;

static void say(const Instance *it, const char *what) {
    ((Logger)it->log)(it->environment, it->name, ERROR, "logStatusError", "%s", what);
}

FMI(const char *, fmi2GetTypesPlatform)(void) { return "default"; }
FMI(const char *, fmi2GetVersion)(void) { return "2.0"; }

FMI(int, fmi2SetDebugLogging)(void *c, int on, size_t n, const char *const categories[]) {
    (void)c, (void)on, (void)n, (void)categories;
    return OK;
}

FMI(void *, fmi2Instantiate)(const char *name, int type, const char *guid, const char *resources,
                             const Callbacks *callbacks, int visible, int logging) {
    const Instance probe = {.log = callbacks ? (void (*)(void))callbacks->logger : NULL,
                            .environment = callbacks ? callbacks->environment : NULL};
    (void)resources, (void)visible, (void)logging;
    if (type != 1) return wrong(&probe, "this is an FMU for co-simulation"), NULL;
    return made(probe, name, guid);
}

FMI(void, fmi2FreeInstance)(void *c) { free(c); }

FMI(int, fmi2SetupExperiment)(void *c, int tolerance_given, double tolerance, double start, int stop_given,
                              double stop) {
    (void)tolerance_given, (void)tolerance, (void)stop_given, (void)stop;
    ((Instance *)c)->time = start;
    return OK;
}

FMI(int, fmi2EnterInitializationMode)(void *c) {
    ((Instance *)c)->phase = 1;
    return OK;
}

FMI(int, fmi2ExitInitializationMode)(void *c) { return begun(c); }

FMI(int, fmi2Terminate)(void *c) {
    (void)c;
    return OK;
}

FMI(int, fmi2Reset)(void *c) { return reset(c); }

FMI(int, fmi2GetReal)(void *c, const unsigned vr[], size_t n, double value[]) {
    int status = OK;
    for (size_t k = 0; k < n && status == OK; k++) status = get(c, vr[k], 0, &value[k]);
    return status;
}

FMI(int, fmi2GetBoolean)(void *c, const unsigned vr[], size_t n, int value[]) {
    int status = OK;
    double one = 0.0;
    for (size_t k = 0; k < n && status == OK; k++) {
        status = get(c, vr[k], FLAG, &one);
        value[k] = one != 0.0;
    }
    return status;
}

FMI(int, fmi2SetReal)(void *c, const unsigned vr[], size_t n, const double value[]) {
    int status = OK;
    for (size_t k = 0; k < n && status == OK; k++) status = set(c, vr[k], 0, value[k]);
    return status;
}

FMI(int, fmi2SetBoolean)(void *c, const unsigned vr[], size_t n, const int value[]) {
    int status = OK;
    for (size_t k = 0; k < n && status == OK; k++) status = set(c, vr[k], FLAG, value[k] != 0);
    return status;
}

FMI(int, fmi2GetInteger)(void *c, const unsigned vr[], size_t n, int v[]) { return (void)vr, (void)v, none(c, n); }
FMI(int, fmi2SetInteger)(void *c, const unsigned vr[], size_t n, const int v[]) {
    return (void)vr, (void)v, none(c, n);
}
FMI(int, fmi2GetString)(void *c, const unsigned vr[], size_t n, const char *v[]) {
    return (void)vr, (void)v, none(c, n);
}
FMI(int, fmi2SetString)(void *c, const unsigned vr[], size_t n, const char *const v[]) {
    return (void)vr, (void)v, none(c, n);
}

FMI(int, fmi2DoStep)(void *c, double time, double step, int no_way_back) {
    (void)no_way_back;
    return stepped(c, time, step);
}

FMI(int, fmi2GetFMUstate)(void *c, void **place) { return kept(c, place); }
FMI(int, fmi2SetFMUstate)(void *c, void *place) { return back(c, place); }
FMI(int, fmi2FreeFMUstate)(void *c, void **place) {
    (void)c;
    return forgotten(place);
}

FMI(int, fmi2SerializedFMUstateSize)(void *c, void *kept, size_t *size) { return (void)kept, (void)size, lacking(c); }
FMI(int, fmi2SerializeFMUstate)(void *c, void *kept, char bytes[], size_t size) {
    return (void)kept, (void)bytes, (void)size, lacking(c);
}
FMI(int, fmi2DeSerializeFMUstate)(void *c, const char bytes[], size_t size, void **kept) {
    return (void)kept, (void)bytes, (void)size, lacking(c);
}
FMI(int, fmi2GetDirectionalDerivative)(void *c, const unsigned of[], size_t n, const unsigned by[], size_t m,
                                       const double seed[], double found[]) {
    return (void)of, (void)n, (void)by, (void)m, (void)seed, (void)found, lacking(c);
}
FMI(int, fmi2SetRealInputDerivatives)(void *c, const unsigned vr[], size_t n, const int order[], const double v[]) {
    return (void)vr, (void)n, (void)order, (void)v, lacking(c);
}
FMI(int, fmi2GetRealOutputDerivatives)(void *c, const unsigned vr[], size_t n, const int order[], double v[]) {
    return (void)vr, (void)n, (void)order, (void)v, lacking(c);
}
FMI(int, fmi2CancelStep)(void *c) { return lacking(c); }
FMI(int, fmi2GetStatus)(void *c, int kind, int *status) { return (void)kind, (void)status, lacking(c); }
FMI(int, fmi2GetRealStatus)(void *c, int kind, double *value) { return (void)kind, (void)value, lacking(c); }
FMI(int, fmi2GetIntegerStatus)(void *c, int kind, int *value) { return (void)kind, (void)value, lacking(c); }
FMI(int, fmi2GetBooleanStatus)(void *c, int kind, int *value) { return (void)kind, (void)value, lacking(c); }
FMI(int, fmi2GetStringStatus)(void *c, int kind, const char **value) { return (void)kind, (void)value, lacking(c); }
