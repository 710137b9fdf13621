/* The muscle on its load: the physics of the model page and its modes, for the C peer.
 *
 * State y = {L, v, P, m}. A mode names every branch of every law, so that the rates are smooth
 * while it lasts; its guards are positive while it lasts. */
#ifndef MUSCLE_H
#define MUSCLE_H

#include <stdbool.h>
#include <stdio.h>

enum { STATES = 4, GUARDS = 8 };

enum port { CLOSED = -1, SUPPLY = 0, EXHAUST = 1 };

/* The pieces of the flow law in order of rising pressure in the actuator. */
enum zone { CHOKED_IN, SUBSONIC_IN, LAMINAR_IN, LAMINAR_OUT, SUBSONIC_OUT, CHOKED_OUT };

enum length_regime { SLACK, FREE, TAUT, REBOUND };

struct mode {
    enum port port;
    enum zone zone;
    enum length_regime length_regime;
    int sliding; /* +1 lengthening, -1 shortening, 0 stuck */
    bool clamped;
};

struct edge {
    double time;
    enum port port;
};

struct muscle {
    /* As given, in SI. */
    double thread_length, turns, min_length, max_length, external_volume;
    double viscous, coulomb_width, stiffness, damping;
    double gamma, gas_constant, atmosphere, supply, temperature, area, laminar_ratio;
    double mass, pull;
    double start[STATES];
    double duration, sample_interval;
    double magnitudes[STATES];
    int initial_port, edge_count;
    struct edge *edges;
    /* Derived. */
    double inverse_turns; /* 1/(4 pi n^2) */
    double throat;        /* eta A_p C_q sqrt(2 gamma/(R (gamma - 1))) */
    double choked, laminar_slope, critical_ratio;
    double inverse_gamma;
    double bounds[2][5]; /* where the zones of a port meet, Pa */
    double band;         /* relative width by which agreeing formulas' border is passed */
    double force_band;   /* the same in N */
};

/* Reads a problem; false if it is not complete. */
bool muscle_read(struct muscle *muscle, FILE *file);
void muscle_set_tolerance(struct muscle *muscle, double tolerance);

struct mode muscle_begin(const struct muscle *muscle, const double *y);
void muscle_open(const struct muscle *muscle, const double *y, enum port port, struct mode *mode);
/* False where a trial stage has left the physics (a negative root). */
bool muscle_rates(const struct muscle *muscle, const struct mode *mode, const double *y,
                  double *rates);
void muscle_guards(const struct muscle *muscle, const struct mode *mode, const double *y,
                   double *guards);
/* What follows when a guard has come down to zero. */
void muscle_cross(const struct muscle *muscle, int guard, double *y, struct mode *mode);

#endif
