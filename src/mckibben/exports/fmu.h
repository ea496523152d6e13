/* What FMI 2.0 and 3.0 share, for co-simulation with a map of a McKibben muscle. C99; no Python, no file, no memory but
   the instance's.

   model.h says what the model is: MODEL_GUID, COUNT, KIND and START of its variables, which are numbered from 0, and

     const char *model_start(Instance *it)        the state from the parameters; what is wrong with them, or NULL
     int model_step(Instance *it, double step)    on by a step; 0 where numbers went out of range
     void model_see(Instance *it)                 the outputs from inputs and state
*/
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    double value[64], state[16], time;
    void (*log)(void); /* of the type that this version of FMI has */
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
#ifdef FUNCTION_PREFIX /* linked into a program together with other models */
#define PASTED(a, b) a##b
#define JOINED(a, b) PASTED(a, b)
#define NAMED(name) JOINED(FUNCTION_PREFIX, name)
#else
#define NAMED(name) name
#endif
#define FMI(type, name) EXPORTED type NAMED(name)

enum { OK, WARNING, DISCARD, ERROR };

static void say(const Instance *it, const char *what); /* by the logger */

static int wrong(const Instance *it, const char *what) {
    if (it->log) say(it, what);
    return ERROR;
}

static int lacking(const Instance *it) { return wrong(it, "this FMU does not offer that"); }

static int none(const Instance *it, size_t n) { return n ? wrong(it, "there are no variables of this type") : OK; }

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
    it->time = 0.0;
    it->phase = 0;
    it->stale = 2;
    return OK;
}

/* an instance like `probe`, or NULL */
static Instance *made(Instance probe, const char *name, const char *guid) {
    snprintf(probe.name, sizeof probe.name, "%s", name ? name : "");
    if (!guid || strcmp(guid, MODEL_GUID)) return wrong(&probe, "the description is of another FMU"), NULL;
    Instance *it = malloc(sizeof *it);
    if (!it) return wrong(&probe, "no memory"), NULL;
    *it = probe;
    reset(it);
    return it;
}

static int begun(Instance *it) {
    const int status = seen(it);
    if (status == OK) it->phase = 2;
    return status;
}

static int is_one(const Instance *it, unsigned vr, int flag) {
    return vr < COUNT && (KIND[vr] & FLAG) == flag ? OK : wrong(it, "there is no variable of this number and type");
}

static int get(Instance *it, unsigned vr, int flag, double *value) {
    const int status = is_one(it, vr, flag) == OK ? seen(it) : ERROR;
    if (status == OK) *value = it->value[vr];
    return status;
}

static int set(Instance *it, unsigned vr, int flag, double value) {
    if (is_one(it, vr, flag) != OK) return ERROR;
    const int kind = KIND[vr] & ~FLAG;
    if (kind == OUTPUT) return wrong(it, "an output cannot be set");
    if (kind == PARAMETER && it->phase == 2) return wrong(it, "a parameter cannot be set after the start");
    if (!(fabs(value) < 1e300)) return wrong(it, "values must be finite numbers");
    if (value != it->value[vr]) it->stale = it->phase == 2 ? 1 : 2;
    it->value[vr] = value;
    return OK;
}

static int stepped(Instance *it, double time, double step) {
    if (it->phase < 2) return wrong(it, "a step before the end of the initialisation");
    if (!(step >= 0.0 && step < 1e300)) return wrong(it, "the step must be a positive number");
    if (!model_step(it, step)) return wrong(it, "the model left the numbers that a computer has: take a smaller step");
    model_see(it);
    it->stale = 0;
    it->time = time + step;
    return OK;
}

static int kept(const Instance *it, void **place) {
    if (!*place) *place = malloc(sizeof(Instance));
    if (!*place) return wrong(it, "no memory");
    memcpy(*place, it, sizeof(Instance));
    return OK;
}

static int back(Instance *it, const void *place) {
    memcpy(it, place, sizeof(Instance));
    return OK;
}

static int forgotten(void **place) {
    free(*place);
    *place = NULL;
    return OK;
}
