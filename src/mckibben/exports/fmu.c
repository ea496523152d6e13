/* FMI 2.0 for co-simulation around a map of a McKibben muscle. C99; no Python, no file, no memory but the instance's.

   model.h says what the model is: MODEL_GUID, COUNT, KIND and START of its variables, which are numbered from 0, and

     const char *model_start(Instance *it)        the state from the parameters; what is wrong with them, or NULL
     int model_step(Instance *it, double step)    on by a step; 0 where numbers went out of range
     void model_see(Instance *it)                 the outputs from inputs and state
*/
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    double value[64], state[16];
    void (*log)(void *, const char *, int, const char *, const char *, ...);
    void *environment;
    char name[128];
    int phase; /* 0 instantiated, 1 initialising, 2 running */
    int stale; /* 1: inputs have changed since the outputs were seen, 2: parameters have, too */
} Instance;

enum { PARAMETER, INPUT, OUTPUT, FLAG = 4 }; /* kinds of variables; a FLAG is a truth value */

#include "model.h"

#if defined _WIN32 || defined __CYGWIN__
#define EXPORTED __declspec(dllexport)
#elif defined __GNUC__
#define EXPORTED __attribute__((visibility("default")))
#else
#define EXPORTED
#endif
#ifdef FMI2_FUNCTION_PREFIX /* linked into a program together with other models */
#define PASTED(a, b) a##b
#define JOINED(a, b) PASTED(a, b)
#define NAMED(name) JOINED(FMI2_FUNCTION_PREFIX, name)
#else
#define NAMED(name) name
#endif
#define FMI(type, name) EXPORTED type NAMED(name)

typedef struct {
    void (*logger)(void *, const char *, int, const char *, const char *, ...);
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*finished)(void *, int);
    void *environment;
} Callbacks;

enum { OK, WARNING, DISCARD, ERROR };

static int wrong(const Instance *it, const char *what) {
    if (it->log) it->log(it->environment, it->name, ERROR, "logStatusError", "%s", what);
    return ERROR;
}

static int seen(Instance *it) {
    if (it->phase < 2 && it->stale == 2) {
        const char *fault = model_start(it);
        if (fault) return wrong(it, fault);
    }
    if (it->stale) model_see(it);
    it->stale = 0;
    return OK;
}

static int reset(Instance *it) {
    memcpy(it->value, START, sizeof START);
    memset(it->state, 0, sizeof it->state);
    it->phase = 0;
    it->stale = 2;
    return OK;
}

FMI(const char *, fmi2GetTypesPlatform)(void) { return "default"; }
FMI(const char *, fmi2GetVersion)(void) { return "2.0"; }

FMI(int, fmi2SetDebugLogging)(void *c, int on, size_t n, const char *const categories[]) {
    (void)c, (void)on, (void)n, (void)categories;
    return OK;
}

FMI(void *, fmi2Instantiate)(const char *name, int type, const char *guid, const char *resources,
                             const Callbacks *callbacks, int visible, int logging) {
    Instance probe = {.log = callbacks ? callbacks->logger : NULL,
                      .environment = callbacks ? callbacks->environment : NULL};
    (void)resources, (void)visible, (void)logging;
    snprintf(probe.name, sizeof probe.name, "%s", name ? name : "");
    if (type != 1) return wrong(&probe, "this is an FMU for co-simulation"), NULL;
    if (!guid || strcmp(guid, MODEL_GUID)) return wrong(&probe, "the description is of another FMU: guid"), NULL;
    Instance *it = malloc(sizeof *it);
    if (!it) return wrong(&probe, "no memory"), NULL;
    *it = probe;
    reset(it);
    return it;
}

FMI(void, fmi2FreeInstance)(void *c) { free(c); }

FMI(int, fmi2SetupExperiment)(void *c, int tolerance_given, double tolerance, double start, int stop_given,
                              double stop) {
    (void)c, (void)tolerance_given, (void)tolerance, (void)start, (void)stop_given, (void)stop;
    return OK;
}

FMI(int, fmi2EnterInitializationMode)(void *c) {
    ((Instance *)c)->phase = 1;
    return OK;
}

FMI(int, fmi2ExitInitializationMode)(void *c) {
    Instance *it = c;
    const int status = seen(it);
    if (status == OK) it->phase = 2;
    return status;
}

FMI(int, fmi2Terminate)(void *c) {
    (void)c;
    return OK;
}

FMI(int, fmi2Reset)(void *c) { return reset(c); }

static int get(Instance *it, const unsigned vr[], size_t n, double *reals, int *flags) {
    const int status = seen(it);
    if (status != OK) return status;
    for (size_t k = 0; k < n; k++) {
        if (vr[k] >= COUNT || !(KIND[vr[k]] & FLAG) != !flags) return wrong(it, "there is no variable of this number");
        if (flags) flags[k] = it->value[vr[k]] != 0.0;
        else reals[k] = it->value[vr[k]];
    }
    return OK;
}

static int set(Instance *it, const unsigned vr[], size_t n, const double *reals, const int *flags) {
    for (size_t k = 0; k < n; k++) {
        if (vr[k] >= COUNT || !(KIND[vr[k]] & FLAG) != !flags) return wrong(it, "there is no variable of this number");
        const int kind = KIND[vr[k]] & ~FLAG;
        if (kind == OUTPUT) return wrong(it, "an output cannot be set");
        if (kind == PARAMETER && it->phase == 2) return wrong(it, "a parameter cannot be set after the start");
        if (!flags && !(fabs(reals[k]) < 1e300)) return wrong(it, "values must be finite numbers");
        const double value = flags ? flags[k] != 0 : reals[k];
        if (value != it->value[vr[k]]) it->stale = it->phase == 2 ? 1 : 2;
        it->value[vr[k]] = value;
    }
    return OK;
}

FMI(int, fmi2GetReal)(void *c, const unsigned vr[], size_t n, double value[]) { return get(c, vr, n, value, NULL); }
FMI(int, fmi2GetBoolean)(void *c, const unsigned vr[], size_t n, int value[]) { return get(c, vr, n, NULL, value); }
FMI(int, fmi2SetReal)(void *c, const unsigned vr[], size_t n, const double v[]) { return set(c, vr, n, v, NULL); }
FMI(int, fmi2SetBoolean)(void *c, const unsigned vr[], size_t n, const int v[]) { return set(c, vr, n, NULL, v); }

static int none(void *c, size_t n) { return n ? wrong(c, "there are no variables of this type") : OK; }

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
    Instance *it = c;
    (void)time, (void)no_way_back;
    if (it->phase < 2) return wrong(it, "a step before the end of the initialisation");
    if (!(step >= 0.0 && step < 1e300)) return wrong(it, "the step must be a positive number");
    if (!model_step(it, step)) return wrong(it, "the model left the numbers that a computer has: take a smaller step");
    model_see(it);
    it->stale = 0;
    return OK;
}

FMI(int, fmi2GetFMUstate)(void *c, void **kept) {
    if (!*kept) *kept = malloc(sizeof(Instance));
    if (!*kept) return wrong(c, "no memory");
    memcpy(*kept, c, sizeof(Instance));
    return OK;
}

FMI(int, fmi2SetFMUstate)(void *c, void *kept) {
    memcpy(c, kept, sizeof(Instance));
    return OK;
}

FMI(int, fmi2FreeFMUstate)(void *c, void **kept) {
    (void)c;
    free(*kept);
    *kept = NULL;
    return OK;
}

static int lacking(void *c) { return wrong(c, "this FMU does not offer that"); }

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
