/* The muscle alone: what it does at a pressure and a length, held over a step. */

static const char *model_start(Instance *it) {
    (void)it;
    return NULL;
}

static int model_step(Instance *it, double step) {
    (void)it, (void)step;
    return 1;
}

static void model_see(Instance *it) {
    double *x = it->value;
    muscle_values at;
    muscle_evaluate(x[length], x[pressure], &at);
    x[force] = x[slack] != 0.0 && at.force < 0.0 ? 0.0 : at.force;
    x[volume] = at.volume;
    x[stiffness] = x[slack] != 0.0 && at.force < 0.0 ? 0.0 : at.stiffness;
    x[volume_by_length] = at.volume_by_length;
    x[volume_by_pressure] = at.volume_by_pressure;
    x[largest_radius] = muscle_largest_radius(x[length], x[pressure]);
    x[inside] = at.inside;
#ifdef RUBS /* there is friction at the crossings */
    x[friction] = muscle_friction(x[length], x[pressure]);
#endif
}
