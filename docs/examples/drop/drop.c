/* A parachute drop past a mast: a program of JSON lines. Build: cc -O2 -o drop drop.c -lm

   Each line of standard input is {"id": 17, "parameters": {"mass": 1.9, "wind": 2.0}}; each line of standard output the
   results, or an error, and the same id. With "trace": true in the line, the answer also has the trace, a row every
   0.05 s. A point mass falls 100 m with drag F = 0.5 rho A C v |v - w|; the mast stands 12 m downwind. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <stdlib.h>

static int number(const char *line, const char *name, double *value) {
    char key[64];
    snprintf(key, sizeof key, "\"%s\":", name);
    const char *at = strstr(line, key);
    return at && sscanf(at + strlen(key), "%lf", value) == 1;
}

enum { ROWS = 10000 };
static double trace[ROWS][4];
static const char *columns[] = {"time", "x", "z", "descent"};

int main(void) {
    char line[4096];
    while (fgets(line, sizeof line, stdin)) {
        double id, mass, wind;
        char same[40] = "";
        if (number(line, "id", &id)) snprintf(same, sizeof same, "\"id\": %.0f, ", id);
        if (!number(line, "mass", &mass) || !number(line, "wind", &wind)) {
            printf("{%s\"error\": \"the parameters mass and wind are expected\"}\n", same);
            fflush(stdout);
            continue;
        }
        int traced = strstr(line, "\"trace\": true") != NULL, rows = 0, step = 0;
        double x = 0, z = 100, u = 0, w = 0, least = 1e9, dt = 1e-3;
        while (z > 0) {
            if (traced && step++ % 50 == 0 && rows < ROWS) {
                double row[] = {dt * (step - 1), x, z, -w};
                memcpy(trace[rows++], row, sizeof row);
            }
            double ru = u - wind, speed = sqrt(ru * ru + w * w), drag = 0.5 * 1.225 * 0.8 * 1.3 * speed / mass;
            u += dt * (-drag * ru);
            w += dt * (-drag * w - 9.81);
            x += dt * u;
            z += dt * w;
            double distance = fabs(x - 12.0) + (z > 30.0 ? z - 30.0 : 0.0);
            if (distance < least) least = distance;
        }
        if (!isfinite(least) || !isfinite(w)) { /* what printf makes of them is not JSON */
            printf("{%s\"error\": \"the fall has no finite result\"}\n", same);
            fflush(stdout);
            continue;
        }
        printf("{%s\"results\": {\"separation\": %.17g, \"impact\": %.17g}", same, least, -w);
        if (traced) {
            printf(", \"trace\": {");
            for (int column = 0; column < 4; column++) {
                printf("%s\"%s\": [", column ? ", " : "", columns[column]);
                for (int row = 0; row < rows; row++) printf("%s%.17g", row ? ", " : "", trace[row][column]);
                printf("]");
            }
            printf("}");
        }
        printf("}\n");
        fflush(stdout); /* without this, every evaluation times out */
    }
    return 0;
}
