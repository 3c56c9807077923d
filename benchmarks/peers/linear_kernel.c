/* The linear loop by hand in C, eight runs to a vector, each with its own matrices: x+ = Phi x + g u, one output a step.

   cc -O3 -march=native -ffast-math -shared -fPIC linear_kernel.c -o linear_kernel.so */

enum { LANES = 8, STATES = 8, PAIRS = STATES / 2, OUTPUTS = 2001 };

typedef double lanes __attribute__((vector_size(LANES * sizeof(double))));

#define EACH(i, n) _Pragma("GCC unroll 8") for (int i = 0; i < (n); i++)

typedef struct { lanes phi[STATES][STATES], g[STATES]; } Dense; /* phi by columns; the output is the last state but one */
typedef struct { lanes own[STATES], other[STATES], g[STATES]; } Modal; /* pairs; the output is the sum of their first states */

void dense(long groups, const Dense *system, const double *u, lanes (*theta)[OUTPUTS]) {
    for (long group = 0; group < groups; group++, system++) {
        lanes x[STATES] = {};
        for (int n = 0; n < OUTPUTS; n++) {
            lanes next[STATES];
            theta[group][n] = x[STATES - 2];
            EACH(i, STATES) next[i] = system->g[i] * u[n];
            EACH(j, STATES) EACH(i, STATES) next[i] += system->phi[j][i] * x[j];
            EACH(i, STATES) x[i] = next[i];
        }
    }
}

void modal(long groups, const Modal *system, const double *u, lanes (*theta)[OUTPUTS]) {
    for (long group = 0; group < groups; group++) {
        const Modal s = system[group];
        lanes x[STATES] = {};
        for (int n = 0; n < OUTPUTS; n++) {
            lanes next[STATES];
            theta[group][n] = (x[0] + x[2]) + (x[4] + x[6]);
            EACH(i, STATES) next[i] = s.g[i] * u[n] + s.own[i] * x[i] + s.other[i] * x[i ^ 1];
            EACH(i, STATES) x[i] = next[i];
        }
    }
}
