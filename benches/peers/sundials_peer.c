/* The same hybrid system through SUNDIALS: ARKODE's explicit Runge-Kutta methods and CVODE, with
 * their own root finding, stop times at valve edges and their own dense output.
 *
 *     sundials_peer METHOD TOLERANCE REPEATS < problem
 *
 * prints `seconds evaluations steps guard-evaluations events`, then length and pressure of each
 * sample. Seconds are the shortest of the repeats; creating the solver is part of the time. */
#include "muscle.h"

#include <arkode/arkode_erkstep.h>
#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <stdlib.h>
#include <string.h>
#include <sundials/sundials_context.h>
#include <sundials/sundials_version.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>
#include <time.h>

struct system {
    const struct muscle *muscle;
    struct mode mode;
};

struct run {
    long evaluations, steps, guard_evaluations, events;
    double *samples; /* length, pressure, length, ... */
    long sample_count;
};

/* One of the two packages behind one interface. */
struct stepper {
    void *memory;
    int (*step)(void *memory, double towards, N_Vector y, double *time);
    int (*restart)(void *memory, double time, N_Vector y);
    int (*stop_at)(void *memory, double time);
    int (*dense)(void *memory, double time, int derivative, N_Vector y);
    int (*roots)(void *memory, int *found);
};

static void check(int code, const char *what) {
    if (code < 0) {
        fprintf(stderr, "SUNDIALS: %s returned %d\n", what, code);
        exit(1);
    }
}

static int rates(double time, N_Vector y, N_Vector slope, void *data) {
    (void)time;
    const struct system *system = data;
    const bool inside = muscle_rates(system->muscle, &system->mode, NV_DATA_S(y), NV_DATA_S(slope));
    return inside ? 0 : 1; /* above zero: try a shorter step */
}

static int guards(double time, N_Vector y, double *values, void *data) {
    (void)time;
    const struct system *system = data;
    muscle_guards(system->muscle, &system->mode, NV_DATA_S(y), values);
    return 0;
}

static int falling[GUARDS] = {-1, -1, -1, -1, -1, -1, -1, -1};
static const long MOST_STEPS = 10000000;

static int erk_step(void *memory, double towards, N_Vector y, double *time) {
    return ERKStepEvolve(memory, towards, y, time, ARK_ONE_STEP);
}

static struct stepper erk_create(const char *method, struct system *system, N_Vector y,
                                 double tolerance, N_Vector absolute, SUNContext context) {
    static const struct {
        const char *name;
        ARKODE_ERKTableID table;
    } tables[] = {
        {"erk-dormand-prince-5", ARKODE_DORMAND_PRINCE_7_4_5},
        {"erk-verner-6", ARKODE_VERNER_8_5_6},
        {"erk-fehlberg-8", ARKODE_FEHLBERG_13_7_8},
    };
    void *memory = ERKStepCreate(rates, 0.0, y, context);
    for (size_t i = 0; i < sizeof tables / sizeof *tables; i++)
        if (strcmp(method, tables[i].name) == 0) {
            check(ERKStepSetTableNum(memory, tables[i].table), "ERKStepSetTableNum");
            check(ERKStepSVtolerances(memory, tolerance, absolute), "ERKStepSVtolerances");
            check(ERKStepSetUserData(memory, system), "ERKStepSetUserData");
            check(ERKStepRootInit(memory, GUARDS, guards), "ERKStepRootInit");
            check(ERKStepSetRootDirection(memory, falling), "ERKStepSetRootDirection");
            check(ERKStepSetNoInactiveRootWarn(memory), "ERKStepSetNoInactiveRootWarn");
            check(ERKStepSetMaxNumSteps(memory, MOST_STEPS), "ERKStepSetMaxNumSteps");
            /* A restart begins with the step of the mode before; order 8 needs more than the
             * default seven tries to shorten it. */
            check(ERKStepSetMaxErrTestFails(memory, 50), "ERKStepSetMaxErrTestFails");
            return (struct stepper){memory,        erk_step,
                                    ERKStepReset,  ERKStepSetStopTime,
                                    ERKStepGetDky, ERKStepGetRootInfo};
        }
    fprintf(stderr, "unknown method %s\n", method);
    exit(2);
}

static int cvode_step(void *memory, double towards, N_Vector y, double *time) {
    return CVode(memory, towards, y, time, CV_ONE_STEP);
}

static struct stepper cvode_create(int family, struct system *system, N_Vector y, double tolerance,
                                   N_Vector absolute, SUNContext context) {
    void *memory = CVodeCreate(family, context);
    check(CVodeInit(memory, rates, 0.0, y), "CVodeInit");
    check(CVodeSVtolerances(memory, tolerance, absolute), "CVodeSVtolerances");
    check(CVodeSetUserData(memory, system), "CVodeSetUserData");
    check(CVodeRootInit(memory, GUARDS, guards), "CVodeRootInit");
    check(CVodeSetRootDirection(memory, falling), "CVodeSetRootDirection");
    check(CVodeSetNoInactiveRootWarn(memory), "CVodeSetNoInactiveRootWarn");
    check(CVodeSetMaxNumSteps(memory, MOST_STEPS), "CVodeSetMaxNumSteps");
    return (struct stepper){memory,           cvode_step,  CVodeReInit,
                            CVodeSetStopTime, CVodeGetDky, CVodeGetRootInfo};
}

/* The whole run. CVODE's counters start again at each restart, so they are collected before. */
static void simulate(const struct muscle *muscle, const char *method, double tolerance,
                     struct run *run) {
    struct system system = {.muscle = muscle};
    SUNContext context;
    check(SUNContext_Create(NULL, &context), "SUNContext_Create");
    N_Vector y = N_VNew_Serial(STATES, context), row = N_VClone(y), absolute = N_VClone(y);
    check(N_VEnableFusedOps_Serial(y, 1), "N_VEnableFusedOps_Serial");
    double *state = NV_DATA_S(y);
    for (int i = 0; i < STATES; i++) {
        state[i] = muscle->start[i];
        NV_Ith_S(absolute, i) = 0.1 * tolerance * muscle->magnitudes[i];
    }
    system.mode = muscle_begin(muscle, state);

    const bool adams = strcmp(method, "cvode-adams") == 0, bdf = strcmp(method, "cvode-bdf") == 0;
    SUNMatrix matrix = NULL;
    SUNLinearSolver linear = NULL;
    SUNNonlinearSolver fixed_point = NULL;
    struct stepper stepper;
    if (adams || bdf) {
        stepper = cvode_create(adams ? CV_ADAMS : CV_BDF, &system, y, tolerance, absolute, context);
        if (adams) {
            fixed_point = SUNNonlinSol_FixedPoint(y, 0, context);
            check(CVodeSetNonlinearSolver(stepper.memory, fixed_point), "CVodeSetNonlinearSolver");
        } else {
            matrix = SUNDenseMatrix(STATES, STATES, context);
            linear = SUNLinSol_Dense(y, matrix, context);
            check(CVodeSetLinearSolver(stepper.memory, linear, matrix), "CVodeSetLinearSolver");
        }
    } else {
        stepper = erk_create(method, &system, y, tolerance, absolute, context);
    }

    *run = (struct run){.samples = run->samples};
    const double end = muscle->duration, interval = muscle->sample_interval;
    const long last = (long)(end / interval * (1.0 + 1e-12));
    double time = 0.0;
    int edge = 0;
    run->samples[0] = state[0], run->samples[1] = state[2];
    run->sample_count = 1;
    while (time < end) {
        double stop = end;
        if (edge < muscle->edge_count && muscle->edges[edge].time < end)
            stop = muscle->edges[edge].time;
        check(stepper.stop_at(stepper.memory, stop), "SetStopTime");
        int code;
        do {
            code = stepper.step(stepper.memory, stop, y, &time);
            check(code, method);
            while (run->sample_count <= last &&
                   (double)run->sample_count * interval <= time + 1e-13) {
                const double instant = (double)run->sample_count * interval;
                double *sample = run->samples + 2 * run->sample_count++;
                check(stepper.dense(stepper.memory, instant < time ? instant : time, 0, row),
                      "GetDky");
                sample[0] = NV_Ith_S(row, 0), sample[1] = NV_Ith_S(row, 2);
            }
        } while (code == CV_SUCCESS);
        run->events++;
        if (adams || bdf) {
            long evaluations, steps, guard_evaluations, of_jacobian = 0;
            CVodeGetNumRhsEvals(stepper.memory, &evaluations);
            CVodeGetNumSteps(stepper.memory, &steps);
            CVodeGetNumGEvals(stepper.memory, &guard_evaluations);
            if (bdf)
                CVodeGetNumLinRhsEvals(stepper.memory, &of_jacobian);
            run->evaluations += evaluations + of_jacobian, run->steps += steps;
            run->guard_evaluations += guard_evaluations;
        }
        if (code == CV_ROOT_RETURN) {
            int found[GUARDS];
            check(stepper.roots(stepper.memory, found), "GetRootInfo");
            for (int i = 0; i < GUARDS; i++)
                if (found[i])
                    muscle_cross(muscle, i, state, &system.mode);
        } else if (stop < end) {
            time = stop;
            muscle_open(muscle, state, muscle->edges[edge++].port, &system.mode);
        } else {
            break;
        }
        check(stepper.restart(stepper.memory, time, y), "restart");
    }

    if (adams || bdf) {
        CVodeFree(&stepper.memory);
    } else {
        ERKStepGetNumRhsEvals(stepper.memory, &run->evaluations);
        ERKStepGetNumSteps(stepper.memory, &run->steps);
        ERKStepGetNumGEvals(stepper.memory, &run->guard_evaluations);
        ERKStepFree(&stepper.memory);
    }
    if (fixed_point)
        SUNNonlinSolFree(fixed_point);
    if (linear)
        SUNLinSolFree(linear);
    if (matrix)
        SUNMatDestroy(matrix);
    N_VDestroy(y);
    N_VDestroy(row);
    N_VDestroy(absolute);
    SUNContext_Free(&context);
}

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

int main(int count, char **arguments) {
    if (count == 2 && strcmp(arguments[1], "--version") == 0) {
        printf("%s\n", SUNDIALS_VERSION);
        return 0;
    }
    struct muscle muscle = {0};
    if (count != 4 || !muscle_read(&muscle, stdin)) {
        fprintf(stderr, "usage: sundials_peer METHOD TOLERANCE REPEATS < problem\n");
        return 2;
    }
    const double tolerance = strtod(arguments[2], NULL);
    const long repeats = strtol(arguments[3], NULL, 10);
    muscle_set_tolerance(&muscle, tolerance);

    const size_t rows = (size_t)(muscle.duration / muscle.sample_interval) + 3;
    struct run run = {.samples = calloc(2 * rows, sizeof(double))};
    double best = 1e300;
    for (long i = 0; i < repeats; i++) {
        const double before = seconds();
        simulate(&muscle, arguments[1], tolerance, &run);
        const double taken = seconds() - before;
        best = taken < best ? taken : best;
    }
    printf("%.9g %ld %ld %ld %ld\n", best, run.evaluations, run.steps, run.guard_evaluations,
           run.events);
    for (long i = 0; i < run.sample_count; i++)
        printf("%.17g %.17g\n", run.samples[2 * i], run.samples[2 * i + 1]);
    free(run.samples);
    free(muscle.edges);
    return 0;
}
