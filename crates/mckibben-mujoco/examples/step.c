/* Loads the plugin into MuJoCo, and steps models with muscles.
 *
 *     cc step.c -I MUJOCO/include -L MUJOCO -lmujoco -o step
 *     ./step libmckibben_mujoco.so models/elbow.xml ...
 *
 * Of each model: the forces after 0.2 s; that a saved state goes on to equal bits in another mjData; and that what is wrong in a
 * model is an error with a message. */

#include <mujoco/mujoco.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void fail(const char *what) {
  fprintf(stderr, "%s\n", what);
  exit(1);
}

static void steps(const mjModel *model, mjData *data, int count) {
  for (int step = 0; step < count; step++) {
    for (int at = 0; at < model->nu; at++) {
      data->ctrl[at] = at % 2 ? 0.2 : 0.8;
    }
    mj_step(model, data);
  }
}

static void run(const char *path) {
  char error[1000] = "";
  mjModel *model = mj_loadXML(path, NULL, error, sizeof error);
  if (!model) {
    fail(error);
  }
  mjData *data = mj_makeData(model), *other = mj_makeData(model);
  steps(model, data, 100);

  int size = mj_stateSize(model, mjSTATE_INTEGRATION);
  mjtNum *state = malloc(size * sizeof *state), *again = malloc(size * sizeof *again);
  mj_getState(model, data, state, mjSTATE_INTEGRATION);
  mj_setState(model, other, state, mjSTATE_INTEGRATION);
  steps(model, data, 100);
  steps(model, other, 100);
  mj_getState(model, data, state, mjSTATE_INTEGRATION);
  mj_getState(model, other, again, mjSTATE_INTEGRATION);
  if (memcmp(state, again, size * sizeof *state)) {
    fail("a saved state goes on otherwise than the data that it was saved from");
  }

  printf("%s:", path);
  for (int at = 0; at < model->nu; at++) {
    printf(" %.3f N", data->actuator_force[at]);
  }
  printf("\n");

  mj_resetData(model, data);
  steps(model, data, 10);
  mjData *copy = mj_copyData(NULL, model, data);
  steps(model, copy, 10);
  mj_deleteData(copy);
  free(again);
  free(state);
  mj_deleteData(other);
  mj_deleteData(data);
  mj_deleteModel(model);
}

/* A model with an attribute that is wrong: its name, or its value. */
static void refused(const char *key, const char *value) {
  char text[1000], error[1000] = "";
  snprintf(text, sizeof text,
           "<mujoco><extension><plugin plugin='mckibben.muscle'/></extension>"
           "<worldbody><body><joint name='j'/><geom size='0.1'/></body></worldbody>"
           "<actuator><plugin joint='j' plugin='mckibben.muscle'><config key='%s' value='%s'/></plugin></actuator></mujoco>",
           key, value);
  mjSpec *spec = mj_parseXMLString(text, NULL, error, sizeof error);
  if (!spec) {
    fail(error);
  }
  if (mj_compile(spec, NULL)) {
    fail("a model with a wrong attribute was taken");
  }
  printf("refused: %s\n", mjs_getError(spec));
  mj_deleteSpec(spec);
}

/* What the plugin refuses is a warning of MuJoCo's. */
static void complain(const char *message) { printf("warning: %s\n", message); }

int main(int count, char **arguments) {
  if (count < 3) {
    fail("usage: step PLUGIN MODEL...");
  }
  mj_loadPluginLibrary(arguments[1]);
  mju_user_warning = complain;
  for (int at = 2; at < count; at++) {
    run(arguments[at]);
  }
  refused("muscle.thread_lenght", "0.1 m");
  refused("initial.gauge_pressure", "-3 bar");
  return 0;
}
