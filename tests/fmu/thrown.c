/* A mass thrown past a mast, with linear drag, as an FMU of FMI 2.0 (-DFMI=2) or 3.0 (-DFMI=3), for co-simulation.

   Each communication step is one step of Heun's method. The parameter `trouble` makes it misbehave at t >= 0.5 s, by the
   numbers in `step`; with 10 it accepts no communication step below 0.01 s. -DLEAK=1: reset keeps the state; -DLEAK=2: the library keeps it, also in a new instance. -DTOKEN is
   the GUID or instantiation token that it accepts. With FMI 2.0 it refuses categories of log messages. -DNORESET: it
   cannot be reset. -DSTARTS: a command that it runs when it is first instantiated; its steps take longer then. */
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#ifndef LEAK
#define LEAK 0
#endif

enum { OK, WARNING, DISCARD, ERROR, FATAL };
enum { MASS = 1, SPEED, ANGLE, TROUBLE, X = 10, Z, SEPARATION, DRAG = 20, STEPS };

typedef void (*Logger2)(void *, const char *, int, const char *, const char *, ...);
typedef void (*Logger3)(void *, int, const char *, const char *);
typedef struct { Logger2 logger; void *(*allocate)(size_t, size_t); void (*release)(void *); void *finished, *environment; } Callbacks;

typedef struct {
    double mass, speed, angle, trouble, state[4], time;
    int drag, steps, started, ended;
    Callbacks callbacks;
    Logger3 log;
    void *environment;
} Model;

static double kept; /* what -DLEAK=2 leaves behind */

static void start(Model *m) {
    m->mass = 2, m->speed = 15, m->angle = 1.0, m->trouble = 0, m->drag = 1, m->steps = 0, m->started = 0, m->ended = 0;
}

static void report(Model *m, int status, const char *text) {
    if (m->callbacks.logger) m->callbacks.logger(m->callbacks.environment, "thrown", status, "logStatusError", "%s of %g kg", text, m->mass);
    if (m->log) m->log(m->environment, status, "logStatusError", text);
}

static int initialise(Model *m) {
    if (m->mass <= 0.75) {
        report(m, ERROR, "cannot throw a mass");
        return ERROR;
    }
    if (LEAK != 1 || !m->started) {
        double begun[4] = {LEAK == 2 ? kept : 0, 0, m->speed * cos(m->angle), m->speed * sin(m->angle)};
        memcpy(m->state, begun, sizeof begun);
    }
    m->started = 1;
    return OK;
}

static void slope(const Model *m, const double *y, double *d) {
    double k = m->drag ? 0.5 / m->mass : 0;
    d[0] = y[2], d[1] = y[3], d[2] = -k * y[2], d[3] = -k * y[3] - 9.81;
}

static int step(Model *m, double time, double h) {
    double a[4], b[4], y[4];
    if (m->trouble == 10 && h < 0.0099) {
        report(m, ERROR, "cannot make a step as short for a mass");
        return ERROR;
    }
    slope(m, m->state, a);
    for (int i = 0; i < 4; i++) y[i] = m->state[i] + h * a[i];
    slope(m, y, b);
    for (int i = 0; i < 4; i++) m->state[i] += h * 0.5 * (a[i] + b[i]);
    kept = 1e-9 * m->state[0];
    m->steps++;
#ifdef STARTS
    usleep(100);
#endif
    m->time = time + h;
    if (m->time < 0.5) return OK;
    switch ((int)m->trouble) {
    case 1: report(m, ERROR, "lost the mass"); return ERROR;
    case 2: return DISCARD;
    case 3: raise(11); return OK;
    case 4: m->ended = 1; return FMI == 2 ? DISCARD : OK;
    case 5: m->state[0] = NAN; return OK;
    case 6: for (volatile int i = 1; i;) {} return OK;
    case 7: report(m, FATAL, "ruined everything"); return FATAL;
    case 8: exit(3);
    case 9: report(m, WARNING, "is worried about the mass"); return WARNING;
    default: return OK;
    }
}

static double *number(Model *m, unsigned reference) {
    switch (reference) {
    case MASS: return &m->mass;
    case SPEED: return &m->speed;
    case ANGLE: return &m->angle;
    case TROUBLE: return &m->trouble;
    case X: return &m->state[0];
    case Z: return &m->state[1];
    default: return NULL;
    }
}

/* The mast stands at x = 12 m and is 8 m high. */
static int get(Model *m, const unsigned *references, size_t n, double *values) {
    for (size_t i = 0; i < n; i++) {
        double *found = number(m, references[i]), dx = m->state[0] - 12, dz = m->state[1] > 8 ? m->state[1] - 8 : 0;
        if (!found && references[i] != SEPARATION) return ERROR;
        values[i] = found ? *found : sqrt(dx * dx + dz * dz);
    }
    return OK;
}

static int set(Model *m, const unsigned *references, size_t n, const double *values) {
    for (size_t i = 0; i < n; i++) {
        double *found = references[i] < X ? number(m, references[i]) : NULL;
        if (!found) return ERROR;
        *found = values[i];
    }
    return OK;
}

static Model *made(const char *token, const char *expected) {
    if (strcmp(token, expected)) return NULL;
    Model *m = calloc(1, sizeof *m);
    start(m);
#ifdef STARTS
    static int started;
    if (!started++) system(STARTS " true");
#endif
    return m;
}

static int reset(Model *m) {
#ifdef NORESET
    return ERROR;
#endif
    int started = m->started;
    start(m);
    if (LEAK == 1) m->started = started;
    return OK;
}

#if FMI == 2
const char *fmi2GetTypesPlatform(void) { return "default"; }
const char *fmi2GetVersion(void) { return "2.0"; }
void *fmi2Instantiate(const char *name, int kind, const char *token, const char *where, const Callbacks *c, int visible, int logging) {
    Model *m = kind == 1 ? made(token, TOKEN) : NULL;
    if (m) m->callbacks = *c;
    else c->logger(c->environment, name, ERROR, "logStatusError", "the GUID is %s", token);
    return m;
}
void fmi2FreeInstance(void *m) { free(m); }
int fmi2SetDebugLogging(void *m, int on, size_t n, const char **categories) { return ERROR; }
int fmi2SetupExperiment(void *m, int defined, double tolerance, double begin, int stops, double stop) { return OK; }
int fmi2EnterInitializationMode(void *m) { return initialise(m); }
int fmi2ExitInitializationMode(void *m) { return OK; }
int fmi2Terminate(void *m) { return OK; }
int fmi2Reset(void *m) { return reset(m); }
int fmi2GetReal(void *m, const unsigned *r, size_t n, double *values) { return get(m, r, n, values); }
int fmi2SetReal(void *m, const unsigned *r, size_t n, const double *values) { return set(m, r, n, values); }
int fmi2SetBoolean(void *m, const unsigned *r, size_t n, const int *values) {
    if (n != 1 || *r != DRAG) return ERROR;
    ((Model *)m)->drag = *values;
    return OK;
}
int fmi2DoStep(void *m, double time, double h, int final) { return step(m, time, h); }
int fmi2GetBooleanStatus(void *m, int kind, int *value) { *value = ((Model *)m)->ended; return OK; }
int fmi2GetRealStatus(void *m, int kind, double *value) { *value = ((Model *)m)->time; return OK; }
#define UNUSED(name) int fmi2##name(void) { return ERROR; }
UNUSED(CancelStep) UNUSED(DeSerializeFMUstate) UNUSED(FreeFMUstate) UNUSED(GetBoolean) UNUSED(GetDirectionalDerivative)
UNUSED(GetFMUstate) UNUSED(GetInteger) UNUSED(GetIntegerStatus) UNUSED(GetRealOutputDerivatives) UNUSED(GetStatus)
UNUSED(GetString) UNUSED(GetStringStatus) UNUSED(SerializeFMUstate) UNUSED(SerializedFMUstateSize) UNUSED(SetFMUstate)
UNUSED(SetInteger) UNUSED(SetRealInputDerivatives) UNUSED(SetString)
#else
const char *fmi3GetVersion(void) { return "3.0"; }
void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *where, bool visible, bool logging, bool events,
                                  bool early, const unsigned *required, size_t n, void *environment, Logger3 log, void *update) {
    Model *m = made(token, TOKEN);
    if (m) m->log = log, m->environment = environment;
    else log(environment, ERROR, "logStatusError", "the token is another one");
    return m;
}
void fmi3FreeInstance(void *m) { free(m); }
int fmi3SetDebugLogging(void *m, bool on, size_t n, const char **categories) { return OK; }
int fmi3EnterInitializationMode(void *m, bool defined, double tolerance, double begin, bool stops, double stop) { return initialise(m); }
int fmi3ExitInitializationMode(void *m) { return OK; }
int fmi3Terminate(void *m) { return OK; }
int fmi3Reset(void *m) { return reset(m); }
int fmi3GetFloat64(void *m, const unsigned *r, size_t n, double *values, size_t size) { return get(m, r, n, values); }
int fmi3SetFloat64(void *m, const unsigned *r, size_t n, const double *values, size_t size) { return set(m, r, n, values); }
int fmi3SetBoolean(void *m, const unsigned *r, size_t n, const bool *values, size_t size) {
    if (n != 1 || *r != DRAG) return ERROR;
    ((Model *)m)->drag = *values;
    return OK;
}
int fmi3DoStep(void *m, double time, double h, bool final, bool *event, bool *ends, bool *early, double *reached) {
    int status = step(m, time, h);
    *event = *early = false;
    *ends = ((Model *)m)->ended;
    *reached = time + h;
    return status;
}
#define UNUSED(name) int fmi3##name(void) { return ERROR; }
UNUSED(ActivateModelPartition) UNUSED(CompletedIntegratorStep) UNUSED(DeserializeFMUState) UNUSED(EnterConfigurationMode)
UNUSED(EnterContinuousTimeMode) UNUSED(EnterEventMode) UNUSED(EnterStepMode) UNUSED(EvaluateDiscreteStates)
UNUSED(ExitConfigurationMode) UNUSED(FreeFMUState) UNUSED(GetAdjointDerivative) UNUSED(GetBinary) UNUSED(GetBoolean)
UNUSED(GetClock) UNUSED(GetContinuousStateDerivatives) UNUSED(GetContinuousStates) UNUSED(GetDirectionalDerivative)
UNUSED(GetEventIndicators) UNUSED(GetFMUState) UNUSED(GetFloat32) UNUSED(GetInt16) UNUSED(GetInt32) UNUSED(GetInt64)
UNUSED(GetInt8) UNUSED(GetIntervalDecimal) UNUSED(GetIntervalFraction) UNUSED(GetNominalsOfContinuousStates)
UNUSED(GetNumberOfContinuousStates) UNUSED(GetNumberOfEventIndicators) UNUSED(GetNumberOfVariableDependencies)
UNUSED(GetOutputDerivatives) UNUSED(GetShiftDecimal) UNUSED(GetShiftFraction) UNUSED(GetString) UNUSED(GetUInt16)
UNUSED(GetUInt32) UNUSED(GetUInt64) UNUSED(GetUInt8) UNUSED(GetVariableDependencies) UNUSED(InstantiateModelExchange)
UNUSED(InstantiateScheduledExecution) UNUSED(SerializeFMUState) UNUSED(SerializedFMUStateSize) UNUSED(SetBinary)
UNUSED(SetClock) UNUSED(SetContinuousStates) UNUSED(SetFMUState) UNUSED(SetFloat32) UNUSED(SetInt16) UNUSED(SetInt32)
UNUSED(SetInt64) UNUSED(SetInt8) UNUSED(SetIntervalDecimal) UNUSED(SetIntervalFraction) UNUSED(SetShiftDecimal)
UNUSED(SetShiftFraction) UNUSED(SetString) UNUSED(SetTime) UNUSED(SetUInt16) UNUSED(SetUInt32) UNUSED(SetUInt64)
UNUSED(SetUInt8) UNUSED(UpdateDiscreteStates)
#endif
