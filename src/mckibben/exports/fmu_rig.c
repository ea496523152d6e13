/* The muscle with a mass on it, and a valve by ISO 6358 between a supply and the atmosphere.

   Of the state: length, speed, absolute pressure and mass of the air in muscle and tube. Balances of momentum, energy
   (in which an exponent n takes the place of 1.4; air of one temperature for n = 1) and mass:

     m h'' = m g + push - F(h, P) - damping h'
     p' (V + n p dV/dP) = n (R (inflow T_in - outflow T_out) - p dV/dh h')
*/
#define GAS 287.05 /* J/kg/K, of air */
#define RHO 1.185  /* kg/m^3 and K to which conductances refer, ISO 8778 */
#define NORMAL 293.15
#define LAMINAR 0.999 /* ratio of pressures above which the flow is straight in their difference */

static double flow(double C, double b, double before, double temperature, double after) {
    const double choked = C * RHO * before * sqrt(NORMAL / temperature), ratio = after / before;
    if (ratio <= b) return choked;
    const double edge = ratio < LAMINAR ? ratio : b > LAMINAR ? b : LAMINAR, over = (edge - b) / (1.0 - b);
    return choked * sqrt(1.0 - over * over) * (ratio < LAMINAR ? 1.0 : (1.0 - ratio) / (1.0 - edge));
}

typedef struct {
    muscle_values at;
    double V, T, in, out; /* volume and temperature of the air; mass flows from the supply and to the atmosphere */
} Seen;

static void rates(const double *x, const double *s, double *rate, Seen *seen) {
    const double h = s[0], v = s[1], p = s[2], n = x[exponent], around = x[temperature_around];
    const double u = x[command] < -1.0 ? -1.0 : x[command] > 1.0 ? 1.0 : x[command];
    const double source = x[supply] + x[atmosphere];
    muscle_evaluate(h, p - x[atmosphere], &seen->at);
    seen->V = seen->at.volume - RUBBER + x[tube];
    seen->T = p * seen->V / (s[3] * GAS);
    seen->in = seen->out = 0.0;
    if (u > 0.0)
        seen->in = p > source ? -flow(u * x[conductance], x[critical_ratio], p, seen->T, source)
                              : flow(u * x[conductance], x[critical_ratio], source, around, p);
    if (u < 0.0)
        seen->out = p < x[atmosphere] ? -flow(-u * x[vent], x[critical_ratio], x[atmosphere], around, p)
                                      : flow(-u * x[vent], x[critical_ratio], p, seen->T, x[atmosphere]);
    const double T_in = seen->in > 0.0 ? around : seen->T, T_out = seen->out > 0.0 ? seen->T : around;
    const double carried = seen->in * T_in - seen->out * T_out;
    rate[0] = v;
    rate[1] = x[gravity] + (x[push] - seen->at.force - x[damping] * v) / x[mass];
    rate[2] = n * (GAS * carried - p * seen->at.volume_by_length * v) / (seen->V + n * p * seen->at.volume_by_pressure);
    rate[3] = seen->in - seen->out;
}

static double surplus(const double *x, double h) {
    return muscle_force(h, x[pressure_start]) - x[mass] * x[gravity] - x[push];
}

/* the longest length at rest: from where the muscle pulls more than the load, down to where it no longer does */
static double resting(const double *x) {
    double shortest, longest, h;
    muscle_lengths(x[pressure_start], &shortest, &longest);
    const double step = (longest - shortest) / 64.0;
    for (h = longest; surplus(x, h) < 0.0 && h < 10.0 * longest;) h += step;
    while (h - step > 0.0 && surplus(x, h - step) > 0.0) h -= step;
    double low = h - step, high = h;
    for (int k = 0; k < 60; k++) {
        h = 0.5 * (low + high);
        if (surplus(x, h) > 0.0) high = h;
        else low = h;
    }
    return h;
}

static const char *model_start(Instance *it) {
    const double *x = it->value;
    double *s = it->state;
    if (!(x[mass] > 0.0)) return "mass must be above 0 kg";
    if (!(x[damping] >= 0.0)) return "damping must be at least 0 N s/m";
    if (!(x[critical_ratio] >= 0.0 && x[critical_ratio] < 1.0)) return "critical_ratio must be from 0 to below 1";
    if (!(x[conductance] > 0.0 && x[vent] > 0.0)) return "conductance and vent must be above 0 m^3/s/Pa";
    if (!(x[exponent] >= 1.0 && x[exponent] <= 1.4)) return "exponent must be from 1 (isothermal) to 1.4 (adiabatic)";
    if (!(x[tube] >= 0.0)) return "tube must be at least 0 m^3";
    if (!(x[atmosphere] > 0.0)) return "atmosphere must be above 0 Pa: it is absolute";
    if (!(x[supply] > 0.0)) return "supply must be above 0 Pa: it is a gauge pressure";
    if (!(x[pressure_start] > -x[atmosphere])) return "pressure_start must be above vacuum: it is a gauge pressure";
    if (!(x[temperature_around] > 0.0)) return "temperature_around must be above 0 K";
    if (!(x[step] > 0.0)) return "step must be above 0 s";
    if (!(x[length_start] >= 0.0)) return "length_start must be a length, or 0 for the length at rest";
    s[0] = x[length_start] > 0.0 ? x[length_start] : resting(x);
    s[1] = 0.0;
    s[2] = x[pressure_start] + x[atmosphere];
    const double V = muscle_volume(s[0], x[pressure_start]) - RUBBER + x[tube];
    if (!(V > 0.0)) return "there is no room for air at length_start";
    s[3] = s[2] * V / (GAS * x[temperature_around]);
    return NULL;
}

/* how many times a second the fastest of air and mass turns: steps are kept well below */
static double fastest(const double *x, double p, const Seen *seen) {
    const double n = x[exponent], V_h = seen->at.volume_by_length, room = seen->V + n * p * seen->at.volume_by_pressure;
    const double C = x[conductance] > x[vent] ? x[conductance] : x[vent], b = x[critical_ratio];
    const double edge = b > LAMINAR ? b : LAMINAR, over = (edge - b) / (1.0 - b);
    const double slope = C * RHO * sqrt(NORMAL / seen->T) * sqrt(1.0 - over * over) / (1.0 - edge);
    const double stiff = fabs(seen->at.stiffness) + n * p * V_h * V_h / room;
    return n * GAS * seen->T * slope / room + sqrt(stiff / x[mass]) + x[damping] / x[mass];
}

/* Runge-Kutta's method of order 4. At the end model_see leaves the rates, and the fastest, for the next step. */
static int model_step(Instance *it, double span) {
    const double *x = it->value;
    double *s = it->state, k[4][4], at[4], done = 0.0;
    Seen seen;
    for (int known = !it->stale; done < span; known = 0) {
        if (known) memcpy(k[0], s + 4, sizeof k[0]);
        else rates(x, s, k[0], &seen);
        const double most = 0.5 / (known ? s[8] : fastest(x, s[2], &seen)), left = span - done;
        const double longest = x[step] < most ? x[step] : most;
        if (!(longest > 1e-9)) return 0;
        const double dt = left / ceil(left / longest * (1.0 - 1e-9));
        for (int stage = 1; stage < 4; stage++) {
            for (int i = 0; i < 4; i++) at[i] = s[i] + (stage < 3 ? 0.5 * dt : dt) * k[stage - 1][i];
            rates(x, at, k[stage], &seen);
        }
        for (int i = 0; i < 4; i++) s[i] += dt / 6.0 * (k[0][i] + 2.0 * (k[1][i] + k[2][i]) + k[3][i]);
        if (!(fabs(s[0]) < 1e6 && fabs(s[1]) < 1e6 && s[2] > 0.0 && s[2] < 1e12 && s[3] > 0.0)) return 0;
        done = left - dt < 1e-12 * span ? span : done + dt;
    }
    return 1;
}

static void model_see(Instance *it) {
    double *x = it->value, *s = it->state;
    Seen seen;
    rates(x, s, s + 4, &seen);
    s[8] = fastest(x, s[2], &seen);
    x[length] = s[0];
    x[speed] = s[1];
    x[force] = seen.at.force;
    x[pressure] = s[2] - x[atmosphere];
    x[air_volume] = seen.V;
    x[air_mass] = s[3];
    x[temperature] = seen.T;
    x[inflow] = seen.in;
    x[outflow] = seen.out;
    x[stiffness] = seen.at.stiffness;
    x[inside] = seen.at.inside;
}
