#include "muscle.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    PRESSURE_DOWN,
    PRESSURE_UP,
    LENGTH_LOW,
    LENGTH_HIGH,
    VELOCITY_ZERO,
    TENSION_ZERO,
    BREAK_LONGER,
    BREAK_SHORTER
};

static bool expect(FILE *file, const char *name, double *value) {
    char word[32];
    return fscanf(file, "%31s %lf", word, value) == 2 && strcmp(word, name) == 0;
}

bool muscle_read(struct muscle *k, FILE *file) {
    double edge_count = 0.0, initial_port = 0.0;
    const struct {
        const char *name;
        double *value;
    } entries[] = {
        {"thread_length", &k->thread_length},
        {"turns", &k->turns},
        {"min_length", &k->min_length},
        {"max_length", &k->max_length},
        {"external_volume", &k->external_volume},
        {"viscous", &k->viscous},
        {"coulomb_width", &k->coulomb_width},
        {"stiffness", &k->stiffness},
        {"damping", &k->damping},
        {"gamma", &k->gamma},
        {"gas_constant", &k->gas_constant},
        {"atmosphere", &k->atmosphere},
        {"supply", &k->supply},
        {"temperature", &k->temperature},
        {"area", &k->area},
        {"laminar_ratio", &k->laminar_ratio},
        {"mass", &k->mass},
        {"pull", &k->pull},
        {"length", &k->start[0]},
        {"velocity", &k->start[1]},
        {"pressure", &k->start[2]},
        {"air_mass", &k->start[3]},
        {"length_scale", &k->magnitudes[0]},
        {"velocity_scale", &k->magnitudes[1]},
        {"pressure_scale", &k->magnitudes[2]},
        {"air_mass_scale", &k->magnitudes[3]},
        {"duration", &k->duration},
        {"sample_interval", &k->sample_interval},
        {"initial_port", &initial_port},
        {"edges", &edge_count},
    };
    for (size_t i = 0; i < sizeof entries / sizeof *entries; i++)
        if (!expect(file, entries[i].name, entries[i].value))
            return false;
    k->initial_port = (int)initial_port;
    k->edge_count = (int)edge_count;
    k->edges = calloc((size_t)k->edge_count + 1, sizeof *k->edges);
    if (!k->edges)
        return false;
    for (int i = 0; i < k->edge_count; i++) {
        int port;
        if (fscanf(file, "%lf %d", &k->edges[i].time, &port) != 2)
            return false;
        k->edges[i].port = (enum port)port;
    }

    const double g = k->gamma, r_lam = k->laminar_ratio;
    k->inverse_turns = 1.0 / (4.0 * M_PI * k->turns * k->turns);
    k->inverse_gamma = 1.0 / g;
    k->critical_ratio = pow(2.0 / (g + 1.0), g / (g - 1.0));
    k->throat = k->area * sqrt(2.0 * g / (k->gas_constant * (g - 1.0)));
    k->choked = k->area * sqrt(g / k->gas_constant * pow(2.0 / (g + 1.0), (g + 1.0) / (g - 1.0)));
    k->laminar_slope =
        k->throat * sqrt(pow(r_lam, 2.0 / g) - pow(r_lam, (g + 1.0) / g)) / (1.0 - r_lam);
    const double beyond[2] = {k->supply, k->atmosphere};
    for (int port = 0; port < 2; port++) {
        double *bounds = k->bounds[port];
        bounds[0] = beyond[port] * k->critical_ratio;
        bounds[1] = beyond[port] * r_lam;
        bounds[2] = beyond[port];
        bounds[3] = beyond[port] / r_lam;
        bounds[4] = beyond[port] / k->critical_ratio;
    }
    return true;
}

void muscle_set_tolerance(struct muscle *k, double tolerance) {
    k->band = fmax(tolerance, 1e-12);
    k->force_band = k->band * k->pull;
}

/* (3), (9): the static force in N, and Q k_sec of (13). */
static inline double static_force(const struct muscle *k, double length, double pressure) {
    return (pressure - k->atmosphere) *
           (3.0 * length * length - k->thread_length * k->thread_length) * k->inverse_turns;
}

static inline double coulomb(const struct muscle *k, double length, double pressure) {
    const double gauge = fmax(pressure - k->atmosphere, 0.0);
    return k->coulomb_width * 3.0 * gauge * (length + k->min_length) * k->inverse_turns;
}

/* (14): the taut braid. */
static inline double limit(const struct muscle *k, double length, double velocity) {
    return k->stiffness * (length - k->max_length) + k->damping * velocity;
}

/* (12) before it is kept from pushing. */
static inline double force(const struct muscle *k, const struct mode *mode, const double *y) {
    double sum =
        static_force(k, y[0], y[2]) + k->viscous * y[1] + mode->sliding * coulomb(k, y[0], y[2]);
    if (mode->length_regime == TAUT)
        sum += limit(k, y[0], y[1]);
    return sum;
}

/* (21), (23): flow from `up` to `down`, kg/s, over sqrt(T_up). */
static inline double flow(const struct muscle *k, enum zone zone, double up, double down) {
    if (zone == CHOKED_IN || zone == CHOKED_OUT)
        return k->choked * up;
    const double ratio = down / up;
    if (zone == LAMINAR_IN || zone == LAMINAR_OUT)
        return k->laminar_slope * up * (1.0 - ratio);
    /* r^(2/g) - r^((g+1)/g) with one power; continued as an odd function where a trial stage has
     * ratio > 1. */
    const double root = pow(ratio, k->inverse_gamma), under = root * (root - ratio);
    return k->throat * up * copysign(sqrt(fabs(under)), under);
}

bool muscle_rates(const struct muscle *k, const struct mode *mode, const double *y, double *rates) {
    const bool slack = mode->length_regime == SLACK, stuck = mode->sliding == 0;
    const double length = slack ? k->min_length : y[0];
    const double velocity = slack || stuck ? 0.0 : y[1];
    const double thread2 = k->thread_length * k->thread_length, length2 = length * length;
    const double volume = length * (thread2 - length2) * k->inverse_turns + k->external_volume;
    const double volume_rate = (thread2 - 3.0 * length2) * k->inverse_turns * velocity;
    const double pressure = y[2], mass = y[3];

    double net = 0.0;
    if (mode->port != CLOSED) {
        const double beyond = mode->port == SUPPLY ? k->supply : k->atmosphere;
        if (mode->zone <= LAMINAR_IN)
            net = flow(k, mode->zone, beyond, pressure) / sqrt(k->temperature);
        else
            net = -flow(k, mode->zone, pressure, beyond) /
                  sqrt(pressure * volume / (mass * k->gas_constant));
    }
    const double tension = slack || mode->clamped ? 0.0 : force(k, mode, y);
    rates[0] = stuck ? 0.0 : y[1];
    rates[1] = stuck ? 0.0 : (k->pull - tension) / k->mass;
    rates[2] = k->gamma * pressure * (net / mass - volume_rate / volume);
    rates[3] = net;
    return isfinite(rates[1]) && isfinite(rates[2]);
}

static void holdable(const struct muscle *k, const double *y, double *least, double *most) {
    const double bound = coulomb(k, y[0], y[2]);
    const double middle = static_force(k, y[0], y[2]) + fmax(limit(k, y[0], 0.0), 0.0);
    *least = y[0] <= k->min_length ? 0.0 : fmax(middle - bound, 0.0);
    *most = fmax(middle + bound, 0.0);
}

void muscle_guards(const struct muscle *k, const struct mode *mode, const double *y,
                   double *guards) {
    for (int i = 0; i < GUARDS; i++)
        guards[i] = 1.0;
    if (mode->port != CLOSED) {
        const double *bounds = k->bounds[mode->port];
        if (mode->zone > CHOKED_IN)
            guards[PRESSURE_DOWN] = y[2] - bounds[mode->zone - 1] * (1.0 - k->band);
        if (mode->zone < CHOKED_OUT)
            guards[PRESSURE_UP] = bounds[mode->zone] * (1.0 + k->band) - y[2];
    }
    if (mode->length_regime == SLACK) {
        guards[LENGTH_LOW] = k->min_length - y[0];
        return;
    }
    if (mode->sliding == 0) {
        double least, most;
        holdable(k, y, &least, &most);
        guards[BREAK_LONGER] = most + k->force_band - k->pull;
        guards[BREAK_SHORTER] = k->pull - least + k->force_band;
        return;
    }
    guards[VELOCITY_ZERO] = mode->sliding * y[1];
    if (mode->length_regime == FREE) {
        guards[LENGTH_LOW] = y[0] - k->min_length;
        guards[LENGTH_HIGH] = k->max_length - y[0];
    } else if (mode->length_regime == TAUT) {
        guards[LENGTH_HIGH] = limit(k, y[0], y[1]);
    } else {
        guards[LENGTH_LOW] = y[0] - k->max_length;
        guards[LENGTH_HIGH] = -limit(k, y[0], y[1]);
    }
    const double tension = force(k, mode, y);
    guards[TENSION_ZERO] = (mode->clamped ? -tension : tension) + k->force_band;
}

static void clamp(const struct muscle *k, const double *y, struct mode *mode) {
    const bool moves = mode->length_regime != SLACK && mode->sliding != 0;
    mode->clamped = moves && force(k, mode, y) < 0.0;
}

static void slide(const struct muscle *k, int direction, const double *y, struct mode *mode) {
    mode->sliding = direction;
    if (direction < 0 && y[0] <= k->min_length)
        mode->length_regime = SLACK;
    clamp(k, y, mode);
}

static void rest_or_slide(const struct muscle *k, const double *y, struct mode *mode) {
    double least, most;
    holdable(k, y, &least, &most);
    const int direction =
        k->pull > most + k->force_band ? 1 : (k->pull < least - k->force_band ? -1 : 0);
    slide(k, direction, y, mode);
}

/* Whether the load rests on the shortest length: it would bounce less than the tolerance. */
static bool rests_on_the_stop(const struct muscle *k, const double *y) {
    double least, most;
    holdable(k, y, &least, &most);
    const double acceleration = fmin(k->pull, most - k->pull) / k->mass;
    return acceleration > 0.0 && y[1] * y[1] <= 2.0 * acceleration * k->band * k->max_length;
}

void muscle_open(const struct muscle *k, const double *y, enum port port, struct mode *mode) {
    mode->port = port;
    mode->zone = CHOKED_IN;
    if (port != CLOSED)
        while (mode->zone < CHOKED_OUT && y[2] > k->bounds[port][mode->zone])
            mode->zone++;
}

struct mode muscle_begin(const struct muscle *k, const double *y) {
    struct mode mode = {.length_regime = FREE, .sliding = y[1] < 0.0 ? -1 : 1, .clamped = false};
    muscle_open(k, y, (enum port)k->initial_port, &mode);
    if (y[0] > k->max_length)
        mode.length_regime = limit(k, y[0], y[1]) >= 0.0 ? TAUT : REBOUND;
    else if (y[0] < k->min_length)
        mode.length_regime = SLACK;
    if (y[1] == 0.0 && mode.length_regime != SLACK)
        rest_or_slide(k, y, &mode);
    clamp(k, y, &mode);
    return mode;
}

void muscle_cross(const struct muscle *k, int guard, double *y, struct mode *mode) {
    switch (guard) {
    case PRESSURE_DOWN:
        mode->zone--;
        break;
    case PRESSURE_UP:
        mode->zone++;
        break;
    case LENGTH_LOW:
        if (mode->length_regime == REBOUND) {
            y[0] = k->max_length;
            mode->length_regime = FREE;
            clamp(k, y, mode);
            break;
        }
        y[0] = k->min_length;
        if (rests_on_the_stop(k, y)) {
            y[1] = 0.0;
            mode->length_regime = FREE;
            slide(k, 0, y, mode);
        } else if (mode->length_regime == FREE) {
            mode->length_regime = SLACK;
            clamp(k, y, mode);
        } else {
            mode->length_regime = FREE;
            slide(k, 1, y, mode);
        }
        break;
    case LENGTH_HIGH:
        if (mode->length_regime == FREE)
            y[0] = k->max_length;
        mode->length_regime = mode->length_regime == TAUT ? REBOUND : TAUT;
        clamp(k, y, mode);
        break;
    case VELOCITY_ZERO:
        y[1] = 0.0;
        rest_or_slide(k, y, mode);
        break;
    case TENSION_ZERO:
        mode->clamped = !mode->clamped;
        break;
    case BREAK_LONGER:
        slide(k, 1, y, mode);
        break;
    case BREAK_SHORTER:
        slide(k, -1, y, mode);
        break;
    default:
        break;
    }
}
