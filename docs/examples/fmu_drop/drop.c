/* A load released from a moving vehicle, as an FMU of FMI 2.0 for co-simulation. Build: sh build.sh

   The load leaves at x = 0, z = 60 m with the speed of the vehicle and falls with drag F = 0.5 rho A C |v| v relative to
   the wind. A mast of 20 m stands 32 m ahead. A communication step is one step of Heun's method; the load stays where
   the first step ends below the ground. Only what a co-simulation calls is implemented; the functions at the end answer
   with an error. */
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

enum { OK, WARNING, DISCARD, ERROR };
enum { MASS, SPEED, WIND, X, Z, SEPARATION };

typedef struct {
    void (*logger)(void *environment, const char *instance, int status, const char *category, const char *text, ...);
    void *(*allocate)(size_t n, size_t size);
    void (*release)(void *memory);
    void (*finished)(void *environment, int status);
    void *environment;
} Callbacks;

typedef struct {
    Callbacks callbacks;
    double given[3]; /* mass [kg], speed [m/s], wind [m/s] */
    double y[4];     /* x, z [m], their derivatives [m/s] */
} Model;

static void slope(const Model *m, const double *y, double *d) {
    double u = y[2] - m->given[WIND], w = y[3], k = 0.5 * 1.225 * 0.15 * sqrt(u * u + w * w) / m->given[MASS];
    d[0] = y[2];
    d[1] = y[3];
    d[2] = -k * u;
    d[3] = -k * w - 9.81;
}

int fmi2Reset(void *instance) {
    Model *m = instance;
    double start[3] = {2.0, 12.0, 0.0};
    memcpy(m->given, start, sizeof start);
    memset(m->y, 0, sizeof m->y);
    return OK;
}

void *fmi2Instantiate(const char *name, int type, const char *guid, const char *resources, const Callbacks *callbacks,
                      int visible, int logging) {
    if (type != 1 || strcmp(guid, "{3d1e3a5e-64a1-4b8e-9f0a-0d4e7b1f2c55}")) return NULL;
    Model *m = callbacks->allocate(1, sizeof *m);
    if (!m) return NULL;
    m->callbacks = *callbacks;
    fmi2Reset(m);
    return m;
}

void fmi2FreeInstance(void *instance) {
    Model *m = instance;
    m->callbacks.release(m);
}

int fmi2SetReal(void *instance, const unsigned *references, size_t n, const double *values) {
    Model *m = instance;
    for (size_t i = 0; i < n; i++) {
        if (references[i] > WIND) return ERROR;
        m->given[references[i]] = values[i];
    }
    return OK;
}

int fmi2GetReal(void *instance, const unsigned *references, size_t n, double *values) {
    const Model *m = instance;
    for (size_t i = 0; i < n; i++) {
        double dx = m->y[0] - 32, dz = m->y[1] > 20 ? m->y[1] - 20 : 0;
        switch (references[i]) {
        case X: values[i] = m->y[0]; break;
        case Z: values[i] = m->y[1]; break;
        case SEPARATION: values[i] = sqrt(dx * dx + dz * dz); break;
        default:
            if (references[i] > WIND) return ERROR;
            values[i] = m->given[references[i]];
        }
    }
    return OK;
}

int fmi2EnterInitializationMode(void *instance) {
    Model *m = instance;
    double start[4] = {0, 60, m->given[SPEED], 0};
    memcpy(m->y, start, sizeof start);
    return OK;
}

int fmi2DoStep(void *instance, double time, double h, int final) {
    Model *m = instance;
    double a[4], b[4], y[4];
    if (m->y[1] < 0) return OK; /* it has landed */
    slope(m, m->y, a);
    for (int i = 0; i < 4; i++) y[i] = m->y[i] + h * a[i];
    slope(m, y, b);
    for (int i = 0; i < 4; i++) m->y[i] += 0.5 * h * (a[i] + b[i]);
    if (isfinite(m->y[0]) && isfinite(m->y[1])) return OK;
    m->callbacks.logger(m->callbacks.environment, "drop", ERROR, "logStatusError", "the state diverged at t = %g s", time);
    return ERROR;
}

const char *fmi2GetTypesPlatform(void) { return "default"; }
const char *fmi2GetVersion(void) { return "2.0"; }
int fmi2SetDebugLogging(void *instance, int on, size_t n, const char **categories) { return OK; }
int fmi2SetupExperiment(void *instance, int defined, double tolerance, double start, int stops, double stop) { return OK; }
int fmi2ExitInitializationMode(void *instance) { return OK; }
int fmi2Terminate(void *instance) { return OK; }

#define ABSENT(name) int fmi2##name(void) { return ERROR; }
ABSENT(CancelStep) ABSENT(DeSerializeFMUstate) ABSENT(FreeFMUstate) ABSENT(GetBoolean) ABSENT(GetBooleanStatus)
ABSENT(GetDirectionalDerivative) ABSENT(GetFMUstate) ABSENT(GetInteger) ABSENT(GetIntegerStatus)
ABSENT(GetRealOutputDerivatives) ABSENT(GetRealStatus) ABSENT(GetStatus) ABSENT(GetString) ABSENT(GetStringStatus)
ABSENT(SerializeFMUstate) ABSENT(SerializedFMUstateSize) ABSENT(SetBoolean) ABSENT(SetFMUstate) ABSENT(SetInteger)
ABSENT(SetRealInputDerivatives) ABSENT(SetString)
