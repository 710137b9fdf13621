/* mckibben: braided pneumatic actuators for a host in C or C++. Made by cbindgen from crates/mckibben-c: do not edit.
 *
 * The header needs C99 or C++11, or a later standard.
 *
 * All quantities are in SI. Pressures are absolute unless a name says gauge. Tension pulls the ends of an actuator together and is
 * zero or more; a rate is positive where a distance grows; a mass flow is positive into the actuator. Distances are between the ends
 * of an actuator, with its tendon.
 *
 * Every pointer is checked for NULL and alignment, and every count against the plant's. The caller promises the rest: plants, batches
 * and runs are live, arrays have as many elements as their counts say and do not overlap, text ends with a zero byte. A plant may be used by one
 * thread at a time; a second one gets MCKIBBEN_STATUS_BUSY. Where a function does not return MCKIBBEN_STATUS_OK, mckibben_last_error
 * says why and what to do. */

#ifndef MCKIBBEN_H
#define MCKIBBEN_H

#include <stddef.h>
#include <stdint.h>

/**
 * What a function returns. `mckibben_last_error` has the text of every status but `MCKIBBEN_STATUS_OK`.
 */
typedef enum mckibben_status {
  /**
   * Done.
   */
  MCKIBBEN_STATUS_OK = 0,
  /**
   * The scenario, a value, an index or an option is wrong. Nothing has changed, but for commands of a batch's step: see
   * `mckibben_batch_step`.
   */
  MCKIBBEN_STATUS_INPUT = 2,
  /**
   * The simulation could not go on. The plant is where it was; of a batch it has stopped.
   */
  MCKIBBEN_STATUS_STOPPED = 3,
  /**
   * A pointer is NULL or not aligned for what it points to. Nothing has changed.
   */
  MCKIBBEN_STATUS_POINTER = 5,
  /**
   * An array has more or fewer elements than the plant needs. Nothing has changed.
   */
  MCKIBBEN_STATUS_COUNT = 6,
  /**
   * Another thread uses the plant or the batch at this moment. Nothing has changed.
   */
  MCKIBBEN_STATUS_BUSY = 7,
  /**
   * A defect of the library, which its text describes. Free the plant; no other function accepts it any more.
   */
  MCKIBBEN_STATUS_DEFECT = 8,
} mckibben_status;

/**
 * What moves the ends of the actuators.
 */
typedef enum mckibben_motion {
  /**
   * The host: it integrates masses and joints, passes distances and takes tensions.
   */
  MCKIBBEN_MOTION_HOST = 0,
  /**
   * The scenario: its loads and mechanisms.
   */
  MCKIBBEN_MOTION_SCENARIO = 1,
} mckibben_motion;

/**
 * Plants that are stepped together.
 */
typedef struct mckibben_batch mckibben_batch;

/**
 * A scenario as a plant that a host steps.
 */
typedef struct mckibben_plant mckibben_plant;

/**
 * A finished run: columns with a row at t = 0, at every sample interval of the scenario, and at the end.
 */
typedef struct mckibben_run mckibben_run;

/**
 * Options for reading a plant. All zero is the default: `mckibben_options options = {0};`.
 */
typedef struct mckibben_options {
  /**
   * What moves the ends: `MCKIBBEN_MOTION_HOST` (0) or `MCKIBBEN_MOTION_SCENARIO` (1).
   */
  int32_t motion;
  /**
   * What the numbers are that valves are commanded by, of all valves: "duty", "request", "position" or "set-point"; NULL for each
   * valve's own: positions of a spool, set points of a pressure regulator, of other valves duty cycles where the scenario or
   * `pulse_frequency` says how often they are pulsed, otherwise requests.
   */
  const char *command_mode;
  /**
   * Frequency in Hz of the pulses of a duty cycle, above zero; 0 for that of the scenario.
   */
  double pulse_frequency;
  /**
   * Longest part of a step in s, above zero. Where the host moves the ends, a step is divided into equal parts no longer than this;
   * 0 for one part. Where the scenario moves, its steps are no longer than this; 0 for `run.step`, or for the longest step that
   * `run.accuracy` allows.
   */
  double max_step;
} mckibben_options;

/**
 * A valve that is commanded by a number.
 */
typedef struct mckibben_command_info {
  /**
   * Name of the actuator, or of all that the valve feeds with "+" between them, a dot, and the mode with "_" for "-":
   * "biceps.duty", "agonist+antagonist.request", "actuator.set_point". A scenario of one actuator calls it "actuator".
   */
  const char *name;
  /**
   * What the number is: "duty", "request", "position" or "set-point".
   */
  const char *mode;
  /**
   * Unit of the number: "Pa" of a set point, otherwise empty.
   */
  const char *unit;
  /**
   * Least number: -1 of every request, though a valve of two positions has two of the three: see `mckibben_command_accepts`.
   */
  double minimum;
  /**
   * Greatest number; of a set point what feeds the valve, infinity where this is not known.
   */
  double maximum;
  /**
   * Frequency of the pulses in Hz; 0 where there are none.
   */
  double pulse_frequency;
} mckibben_command_info;

/**
 * A number that is read of a plant.
 */
typedef struct mckibben_output_info {
  /**
   * Name of the part and of the quantity, without a unit: "biceps.gauge_pressure" where a run has the column
   * "biceps.gauge_pressure_pa". A scenario of one actuator calls it "actuator", a joint its actuators "agonist" and "antagonist" and
   * itself "joint", and both their supply "supply", where runs have "gauge_pressure_pa", "antagonist_gauge_pressure_pa",
   * "angle_rad" and "supply_gauge_pressure_pa".
   */
  const char *name;
  /**
   * SI unit, such as "Pa", "m/s", "m3" or "N*m"; empty of a pure number.
   */
  const char *unit;
} mckibben_output_info;

/**
 * How an actuator responds where its ends are, and how its air changes.
 */
typedef struct mckibben_response {
  /**
   * Tension in N, zero or more; it pulls the ends together.
   */
  double tension;
  /**
   * Partial derivative of the tension with respect to the distance in N/m, at constant pressure.
   */
  double per_length;
  /**
   * Partial derivative of the tension with respect to the rate of the distance in N·s/m.
   */
  double per_velocity;
  /**
   * Partial derivative of the tension with respect to the pressure in m² (N/Pa).
   */
  double per_pressure;
  /**
   * Rate of the pressure in Pa/s, positive where it rises.
   */
  double pressure_rate;
  /**
   * Mass flow of air in kg/s, positive into the actuator.
   */
  double mass_flow;
  /**
   * Temperature of the air in K.
   */
  double temperature;
  /**
   * Volume of the air in braid and fittings (`actuator.external_volume`) in m³, without that of a hose.
   */
  double volume;
} mckibben_response;

/**
 * One step of a batch. Arrays have a row for each plant, one after the other; each row has as many elements as its count says.
 */
typedef struct mckibben_step {
  /**
   * The time in s that all plants go on to, as in `mckibben_advance`.
   */
  double until;
  /**
   * Numbers that valves are commanded by, as in `mckibben_command`; NULL to leave valves as they are.
   */
  const double *commands;
  /**
   * Commands of each plant: `mckibben_command_count`; 0 with NULL.
   */
  size_t command_count;
  /**
   * Distances in m, as in `mckibben_advance`; NULL where scenarios move.
   */
  const double *distances;
  /**
   * Distances of each plant: `mckibben_distance_count`; 0 with NULL.
   */
  size_t distance_count;
  /**
   * Where responses are written that the plants have after the step; NULL for none.
   */
  struct mckibben_response *responses;
  /**
   * Responses of each plant: `mckibben_actuator_count`; 0 with NULL.
   */
  size_t response_count;
  /**
   * Where outputs are written that the plants have after the step; NULL for none.
   */
  double *outputs;
  /**
   * Outputs of each plant: `mckibben_output_count`; 0 with NULL.
   */
  size_t output_count;
} mckibben_step;

/**
 * Is called with the time in s that a run has reached, now and then, and the caller's `data`. A result other than 0 ends the run.
 * It must not throw an exception.
 */
typedef int32_t (*mckibben_progress)(double time, void *data);

/**
 * A column of a run.
 */
typedef struct mckibben_column_info {
  /**
   * Name with the unit at its end, such as "absolute_pressure_pa".
   */
  const char *name;
  /**
   * SI unit, such as "Pa"; empty of words.
   */
  const char *unit;
  /**
   * 0 where the column has numbers, 1 where it has words.
   */
  int32_t has_words;
} mckibben_column_info;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/**
 * Returns the version of the library, such as "0.1.0". The text is constant.
 */
const char *mckibben_version(void);

/**
 * Returns what the last function that failed in this thread refused, and what to do about it, in UTF-8: several lines for a
 * mistake in a scenario, which show its place. Empty where none has failed, never NULL. Valid until the next failure in this
 * thread; a success leaves it as it is.
 */
const char *mckibben_last_error(void);

/**
 * Reads the plant of a scenario from its text in TOML: one actuator, a joint, or many actuators on one air network. Its own
 * commands and controllers are not used. Where the scenario moves and has no `run.step`, reading runs it several times to find the
 * longest step that `run.accuracy` allows, which can take minutes. `name` stands for a file's name in messages; NULL for
 * "scenario.toml". `options` may be NULL. On success `*plant` is a plant to be freed by `mckibben_plant_free`; otherwise it is
 * NULL.
 */
enum mckibben_status mckibben_plant_from_text(const char *text,
                                              const char *name,
                                              const struct mckibben_options *options,
                                              struct mckibben_plant **plant);

/**
 * Reads the plant of a scenario from a file, whose path is UTF-8; otherwise as `mckibben_plant_from_text`.
 */
enum mckibben_status mckibben_plant_from_file(const char *path,
                                              const struct mckibben_options *options,
                                              struct mckibben_plant **plant);

/**
 * Copies a plant with the state that it is in; the copy is independent. On success `*copy` is to be freed by
 * `mckibben_plant_free`; otherwise it is NULL.
 */
enum mckibben_status mckibben_plant_clone(const struct mckibben_plant *plant, struct mckibben_plant **copy);

/**
 * Frees a plant, with the names that it has handed out. NULL is no mistake. A plant that has been freed, or that another thread
 * uses, must not be given: that cannot be checked.
 */
void mckibben_plant_free(struct mckibben_plant *plant);

/**
 * Returns how many actuators there are; 0 for NULL.
 */
size_t mckibben_actuator_count(const struct mckibben_plant *plant);

/**
 * Returns how many valves are commanded; 0 for NULL.
 */
size_t mckibben_command_count(const struct mckibben_plant *plant);

/**
 * Returns how many numbers `mckibben_outputs` writes; 0 for NULL.
 */
size_t mckibben_output_count(const struct mckibben_plant *plant);

/**
 * Returns how many distances `mckibben_advance` takes: one for each actuator, or 0 where the scenario moves; 0 for NULL.
 */
size_t mckibben_distance_count(const struct mckibben_plant *plant);

/**
 * Returns how many numbers a state is, as many at all times; 0 for NULL.
 */
size_t mckibben_state_size(const struct mckibben_plant *plant);

/**
 * Returns the name of an actuator, counted from 0; NULL where there is none. Valid while the plant lives.
 */
const char *mckibben_actuator_name(const struct mckibben_plant *plant, size_t actuator);

/**
 * Writes what a command is, counted from 0. Its texts are valid while the plant lives.
 */
enum mckibben_status mckibben_command_describe(const struct mckibben_plant *plant,
                                               size_t command,
                                               struct mckibben_command_info *info);

/**
 * Writes what an output is, counted from 0. Its texts are valid while the plant lives.
 */
enum mckibben_status mckibben_output_describe(const struct mckibben_plant *plant,
                                              size_t output,
                                              struct mckibben_output_info *info);

/**
 * Writes the index of the output of a name, such as "biceps.gauge_pressure".
 */
enum mckibben_status mckibben_output_index(const struct mckibben_plant *plant,
                                           const char *name,
                                           size_t *index);

/**
 * Commands a valve by a number until the next command; commands are counted from 0. The range and the unit of `number` are those of
 * `mckibben_command_describe`: a duty cycle from 0 to 1; a request 1 (fill), 0 (hold) or -1 (exhaust), where the valve has it: see
 * `mckibben_command_accepts`; a position of a spool from -1 (exhaust) to 1 (supply); a set point in Pa, gauge, from zero to what
 * feeds the valve. A number that is set already changes nothing. A request, a position or a set point takes effect now, after the
 * delays of the valve. A duty cycle takes effect at the next pulse: pulse p begins at p/f on the clock of the plant. Before
 * its first command a valve rests: coils are released, so that a normally open valve fills and a three-way valve exhausts; a spool
 * is in the middle; a pressure regulator gives the actuator's initial pressure.
 */
enum mckibben_status mckibben_command(struct mckibben_plant *plant,
                                      size_t command,
                                      double number);

/**
 * Writes to `accepts` whether a valve takes a number as its command, 1 or 0; commands are counted from 0. A two-way valve holds and
 * does not exhaust, and a three-way valve exhausts and does not hold: both take two of the three requests.
 */
enum mckibben_status mckibben_command_accepts(const struct mckibben_plant *plant,
                                              size_t command,
                                              double number,
                                              int32_t *accepts);

/**
 * Advances the plant to the time `until` in s, later than `mckibben_time`; a time in the past is refused.
 *
 * Where the host moves the ends, they go in straight lines to `distances` in m, `count` of them: one for each actuator between its
 * ends, with its tendon. The air takes one step for the call, or equal parts no longer than `options.max_step`; `run.step`,
 * `run.accuracy` and `run.sample_interval` are not used. Events of valves and friction are at their instants within a step.
 *
 * Where the scenario moves, `distances` is NULL and `count` 0, and the plant takes steps of `run.step`, or of the longest that
 * `run.accuracy` allows for the scenario's own run, never longer than `options.max_step`. An `until` that is equal to
 * `mckibben_time` changes nothing.
 */
enum mckibben_status mckibben_advance(struct mckibben_plant *plant,
                                      double until,
                                      const double *distances,
                                      size_t count);

/**
 * Writes the responses of all actuators, one for each, with the ends at `distances` in m and moving at `rates` in m/s (positive
 * where a distance grows), `count` of each. Both NULL, with a `count` of 0, mean where the ends are. The state of the plant stays.
 */
enum mckibben_status mckibben_compute(struct mckibben_plant *plant,
                                      const double *distances,
                                      const double *rates,
                                      size_t count,
                                      struct mckibben_response *responses,
                                      size_t response_count);

/**
 * Writes all outputs where the plant is, `count` of them, in SI units: the columns of a run that are numbers, without the time and
 * the set points of valves, then the contraction of each actuator. Their names differ from those of columns: see
 * `mckibben_output_describe`.
 */
enum mckibben_status mckibben_outputs(struct mckibben_plant *plant,
                                      double *outputs,
                                      size_t count);

/**
 * Writes the time in s that the plant has reached, from 0.
 */
enum mckibben_status mckibben_time(const struct mckibben_plant *plant, double *time);

/**
 * Writes the distances in m between the ends, `count` of them: one for each actuator whose ends the host moves.
 */
enum mckibben_status mckibben_distances(const struct mckibben_plant *plant,
                                        double *distances,
                                        size_t count);

/**
 * Begins the plant again at time 0 with the ends at `distances` in m and moving at `rates` in m/s, `count` of each, and all else as the
 * scenario starts; valves are to be commanded again. Allocates. Refused where the scenario moves.
 */
enum mckibben_status mckibben_begin_at(struct mckibben_plant *plant,
                                       const double *distances,
                                       const double *rates,
                                       size_t count);

/**
 * Returns to where the plant began: the start of the scenario at time 0, or where `mckibben_begin_at` or `mckibben_batch_begin_at` has
 * put it last. A copy, also one out of a batch, returns to where the copied plant began. Valves are to be commanded again.
 */
enum mckibben_status mckibben_reset(struct mckibben_plant *plant);

/**
 * Saves the whole state as `count` numbers: a mark of the scenario and of how its valves are commanded, time, air, valves with their
 * commands, and what friction remembers. Their meaning may change from one version to the next. Refused where more than 64 commands of one valve are within its dead time:
 * `mckibben_plant_clone` copies such a plant.
 */
enum mckibben_status mckibben_save(struct mckibben_plant *plant,
                                   double *numbers,
                                   size_t count);

/**
 * Restores a state that a plant of an equal scenario saved, as `count` numbers; from there the plant continues bit-identically. A state of
 * another scenario, command mode, pulse frequency or motion is refused. Only the commands, controllers, start and run of the scenario
 * may differ, and where the host moves the ends its load and mechanism.
 */
enum mckibben_status mckibben_restore(struct mckibben_plant *plant,
                                      const double *numbers,
                                      size_t count);

/**
 * Makes a batch of `plant_count` plants, each from where its plant is; the plants themselves stay, and one may stand in the array
 * many times. `threads` threads step them; 0 and 1 leave all to the caller's. On success `*batch` is a batch to be freed by
 * `mckibben_batch_free`; otherwise it is NULL.
 *
 * The plants are of one scenario, or of scenarios that differ in numbers. All must agree in these: the time; the motion and
 * `options.max_step`; names of actuators, commands and outputs; modes of commands, and of duty cycles the frequency and the requests
 * in pulses and between them; the number of numbers of a state, which differs where a valve has a dead time and another has none;
 * and where the scenario moves, `run.method` and the step. Give one `run.step` to all, or an `options.max_step` no longer than the step
 * of any, and one `options.pulse_frequency`.
 */
enum mckibben_status mckibben_batch_from_plants(const struct mckibben_plant *const *plants,
                                                size_t plant_count,
                                                size_t threads,
                                                struct mckibben_batch **batch);

/**
 * Ends the threads of a batch and frees it; nothing for NULL.
 */
void mckibben_batch_free(struct mckibben_batch *batch);

/**
 * Returns the number of plants of a batch; 0 for NULL.
 */
size_t mckibben_batch_count(const struct mckibben_batch *batch);

/**
 * Steps all plants of a batch: commands their valves, goes on to `step->until`, and writes responses and outputs. Where an argument
 * is wrong no plant moves and nothing is written. A wrong pointer, count or command leaves the valves as they were; where a time or a
 * distance is refused, they have been commanded. A plant that leaves the physics stops,
 * while the others go on: its status says so, in this step and in later ones, and its responses and outputs are not numbers (NaN).
 * `statuses` has one status for each plant, or is NULL. Returns the status of the first plant that has stopped, with its text.
 */
enum mckibben_status mckibben_batch_step(struct mckibben_batch *batch,
                                         const struct mckibben_step *step,
                                         enum mckibben_status *statuses);

/**
 * A plant of a batch, counted from 0, begins again at the time of the batch, with its ends at `distances` in m and moving at `rates`
 * in m/s, `count` of each, and all else as the scenario starts. Its valves are commanded nothing. Allocates.
 */
enum mckibben_status mckibben_batch_begin_at(struct mckibben_batch *batch,
                                             size_t plant,
                                             const double *distances,
                                             const double *rates,
                                             size_t count);

/**
 * Makes a plant from where a plant of a batch is, counted from 0: to save it, or to step it alone. `mckibben_batch_from_plants` takes
 * it back. On success `*plant` is a plant to be freed by `mckibben_plant_free`; otherwise it is NULL.
 */
enum mckibben_status mckibben_batch_plant(struct mckibben_batch *batch,
                                          size_t index,
                                          struct mckibben_plant **plant);

/**
 * Runs a scenario from its text in TOML to its end, with its own commands and controllers. `name` stands for a file's name in
 * messages; NULL for "scenario.toml". `progress` may be NULL. On success `*run` is to be freed by `mckibben_run_free`; otherwise
 * it is NULL. Warnings, events and the energy ledger of a run are not in this interface: `mckibben simulate` and Python have them.
 */
enum mckibben_status mckibben_simulate_text(const char *text,
                                            const char *name,
                                            mckibben_progress progress,
                                            void *data,
                                            struct mckibben_run **run);

/**
 * Runs a scenario from a file, whose path is UTF-8; otherwise as `mckibben_simulate_text`.
 */
enum mckibben_status mckibben_simulate_file(const char *path,
                                            mckibben_progress progress,
                                            void *data,
                                            struct mckibben_run **run);

/**
 * Frees a run, with the texts that it has handed out. NULL is no mistake. A run that has been freed must not be given: that cannot
 * be checked.
 */
void mckibben_run_free(struct mckibben_run *run);

/**
 * Returns how many rows each column of a run has; 0 for NULL.
 */
size_t mckibben_run_row_count(const struct mckibben_run *run);

/**
 * Returns how many columns a run has; 0 for NULL.
 */
size_t mckibben_run_column_count(const struct mckibben_run *run);

/**
 * Writes what a column of a run is, counted from 0. Its texts are valid while the run lives.
 */
enum mckibben_status mckibben_run_column_describe(const struct mckibben_run *run,
                                                  size_t column,
                                                  struct mckibben_column_info *info);

/**
 * Writes the numbers of a column of a run, in SI units: `count` of them, one for each row.
 */
enum mckibben_status mckibben_run_column(const struct mckibben_run *run,
                                         size_t column,
                                         double *numbers,
                                         size_t count);

/**
 * Returns the word in a column and a row of a run, such as the length regime "taut"; NULL where there is none. Valid while the
 * run lives.
 */
const char *mckibben_run_word(const struct mckibben_run *run,
                              size_t column,
                              size_t row);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* MCKIBBEN_H */
