/* A mass hangs on one actuator, and this program integrates it: a step of 0.1 ms takes the tension, moves the mass, and then moves the
 * end of the actuator. The valve is pulsed at 25 Hz, at half duty for 1 s and at full duty from then on.
 *
 *     cc hanging_mass.c -lmckibben_c -o hanging_mass
 */
#include <mckibben.h>
#include <stdio.h>
#include <stdlib.h>

static const char scenario[] = "[supply]\n"
                               "gauge_pressure = '100 psi'\n"
                               "[valve]\n"
                               "preset = 'matrix-eight-channel'\n"
                               "[command]\n"
                               "kind = 'pwm'\n"
                               "frequency = '25 Hz'\n"
                               "duty = 0.5\n"
                               "[load]\n"
                               "kind = 'isometric'\n"
                               "[initial]\n"
                               "length = '90 mm'\n"
                               "gauge_pressure = '40 psi'\n"
                               "[run]\n"
                               "duration = '1 s'\n";

/* Ends the program where a call fails. */
static void check(mckibben_status status)
{
    if (status != MCKIBBEN_STATUS_OK) {
        fprintf(stderr, "%s\n", mckibben_last_error());
        exit(EXIT_FAILURE);
    }
}

int main(void)
{
    const double gravity = 9.80665; /* m/s^2 */
    const double mass = 2.26796185; /* kg, 5 lb */
    const double step = 1e-4;       /* s */
    double length = 0.09;           /* m */
    double velocity = 0.0;          /* m/s, positive downwards, where the actuator lengthens */
    mckibben_plant *muscle = NULL;
    mckibben_response response;

    check(mckibben_plant_from_text(scenario, "hanging_mass.c", NULL, &muscle));
    for (int k = 1; k <= 20000; ++k) {
        check(mckibben_command(muscle, 0, k <= 10000 ? 0.5 : 1.0));
        check(mckibben_compute(muscle, &length, &velocity, 1, &response, 1));
        velocity += (gravity - response.tension / mass) * step;
        length += velocity * step;
        check(mckibben_advance(muscle, k * step, &length, 1));
    }
    check(mckibben_compute(muscle, NULL, NULL, 0, &response, 1));
    printf("length %.17g m, tension %.17g N\n", length, response.tension);
    mckibben_plant_free(muscle);
    return EXIT_SUCCESS;
}
