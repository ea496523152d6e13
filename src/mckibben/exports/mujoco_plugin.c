/* The actuator: minus the force of the muscle [N], of the actuator's length [m] and its activation, or where it has none
   its control, as the gauge pressure [Pa]. */
#include <string.h>

#include <mujoco/mujoco.h>

#if mjVERSION_HEADER >= 4000000
#define ACTUATORS(m) ((m)->nactuator)
#define CONTROL(m, i) ((m)->actuator_ctrladr[i])
#else
#define ACTUATORS(m) ((m)->nu)
#define CONTROL(m, i) (i)
#endif

static int no_state(const mjModel *m, int instance) { return (void)m, (void)instance, 0; }
static int start(const mjModel *m, mjData *d, int instance) { return (void)m, (void)d, (void)instance, 0; }
static void restart(const mjModel *m, mjtNum *state, void *kept, int instance) {
    (void)m, (void)state, (void)kept, (void)instance;
}

static void pull(const mjModel *m, mjData *d, int instance, int capability) {
    (void)capability;
    const char *pushes = mj_getPluginConfig(m, instance, "pushes");
    const int free_to_push = pushes && !strcmp(pushes, "true");
    for (int i = 0; i < ACTUATORS(m); i++) {
        if (m->actuator_plugin[i] != instance) continue;
        const int at = m->actuator_actadr[i] + m->actuator_actnum[i] - 1;
        const double P = m->actuator_actadr[i] >= 0 ? d->act[at] : d->ctrl[CONTROL(m, i)];
        const double F = muscle_force(d->actuator_length[i], P);
        d->actuator_force[i] = F < 0.0 && !free_to_push ? 0.0 : -F;
    }
}

mjPLUGIN_LIB_INIT(mckibben_@NAME@) {
    static const char *const attributes[] = {"pushes"};
    mjpPlugin plugin;
    mjp_defaultPlugin(&plugin);
    plugin.name = "mckibben.@NAME@";
    plugin.nattribute = 1;
    plugin.attributes = attributes;
    plugin.capabilityflags = mjPLUGIN_ACTUATOR;
    plugin.nstate = no_state;
    plugin.init = start;
    plugin.reset = restart;
    plugin.compute = pull;
    mjp_registerPlugin(&plugin);
}
