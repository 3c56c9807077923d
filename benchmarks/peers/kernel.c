/* The nonlinear case by hand in C, eight runs to a vector: Runge-Kutta steps, the pressure slaved to first order, dry
   friction set-valued by steps. The scaled equations and the order of the coefficients are those of case.py. Two vectors
   take each stage in turn: one waits for its square root while the other computes.

   cc -O3 -march=native -ffast-math -shared -fPIC kernel.c -o kernel.so -lm */

#include <math.h>
#ifdef __AVX512DQ__
#include <immintrin.h>
#endif

#ifndef OUTPUTS_PER_STEP
#define OUTPUTS_PER_STEP 1 /* 1 ms each; with 2 the output between is theta's cubic */
#endif

enum { LANES = 8, GROUPS = 2, ROWS = 18, OUTPUTS = 2001, STEP_OUTPUT = 100 };
enum { R_Z, T_P, A_P, A_F, F, STOP, STOP_STIFFNESS, STOP_DAMPING, G_Z, G_X, G_P, LIMIT, W2, ZW, D_P, D_1, D_0, THETA };

typedef double lanes __attribute__((vector_size(LANES * sizeof(double))));
typedef long long mask __attribute__((vector_size(LANES * sizeof(double))));

#define EACH _Pragma("GCC unroll 2") for (int j = 0; j < GROUPS; j++)
#define FOR_LANES for (int i = 0; i < LANES; i++)
static const mask SIGN = {1LL << 63, 1LL << 63, 1LL << 63, 1LL << 63, 1LL << 63, 1LL << 63, 1LL << 63, 1LL << 63};

static inline lanes all(double x) { return x - (lanes){}; }
static inline lanes size_of(lanes x) { return (lanes)((mask)x & ~SIGN); }
static inline lanes with_sign(lanes x, lanes sign) { return (lanes)((mask)x ^ ((mask)sign & SIGN)); } /* x sgn(sign) */
static inline lanes where(mask m, lanes x, lanes y) { return (lanes)((m & (mask)x) | (~m & (mask)y)); }
static inline lanes least(lanes x, lanes y) { return where(x < y, x, y); }
static inline lanes most(lanes x, lanes y) { return where(x > y, x, y); }

static inline lanes root(lanes x) {
    FOR_LANES x[i] = sqrt(x[i]);
    return x;
}

static inline int any(mask m) {
#ifdef __AVX512DQ__
    return _mm512_movepi64_mask((__m512i)m) != 0;
#else
    long long found = 0;
    FOR_LANES found |= m[i];
    return found != 0;
#endif
}

typedef struct { lanes Z, Q, Q1, X, V, D, D1; } State;
typedef struct { lanes Z, Q1, V, D1, free; } Rates;

static inline State moved(State y, lanes h, State at, Rates rate) {
    return (State){y.Z + h * rate.Z,  y.Q + h * at.Q1, y.Q1 + h * rate.Q1, y.X + h * at.V,
                   y.V + h * rate.V,  y.D + h * at.D1, y.D1 + h * rate.D1};
}

static inline __attribute__((always_inline)) Rates derivative(State y, lanes push, mask moving, const lanes *c) {
    lanes size = size_of(y.Q);
    lanes W = 1.0 - with_sign(y.Z - y.V, y.Q);
    lanes square = size * size + size_of(W);
    lanes u = root(square) - size;
    lanes U = with_sign(u, W);
    lanes P = with_sign(1.0 - U * u, y.Q);
    lanes over = size_of(y.X) - c[STOP];
    if (any(over > 0)) {
        lanes stop = most(c[STOP_STIFFNESS] * over + with_sign(c[STOP_DAMPING] * y.V, y.X), all(0));
        push -= with_sign(where(over > 0, stop, all(0)), y.X);
    }
    lanes Z1 = c[R_Z] * (2 * y.Q * U - y.V);
    lanes V1 = push + c[A_P] * P;
    lanes E = c[T_P] / square * u * (Z1 + 2 * U * y.Q1 - (lanes)(moving & (mask)V1));
    P -= u * E;
    lanes command = y.D - c[G_Z] * y.Z - c[G_X] * y.X + c[G_P] * P;
    command = most(least(command, c[LIMIT]), -c[LIMIT]);
    lanes free = push + c[A_P] * P;
    return (Rates){Z1 + c[R_Z] * size * E, c[W2] * (command - y.Q) - c[ZW] * y.Q1, (lanes)(moving & (mask)free),
                   -(c[D_P] * P + c[D_1] * y.D1 + c[D_0] * y.D), free};
}

/* Friction of one step: its direction, the torques besides the pressure's, which columns move. */
typedef struct { lanes direction, push; mask moving; } Mode;

static inline __attribute__((always_inline)) Mode mode_at(State y, lanes force, const lanes *c) {
    lanes free = derivative(y, force, (mask){}, c).free;
    mask rest = y.V == 0;
    lanes direction = with_sign(all(1), where(rest, free, y.V));
    return (Mode){direction, force - direction * c[A_F], ~rest | (size_of(free) > c[A_F])};
}

static inline __attribute__((always_inline)) State landed(State y, const State *at, const Rates *rate, Mode mode, double h,
                                                          const lanes *c) {
    lanes s = all(h / 6);
#define SUM(of, part) (of[0].part + 2 * (of[1].part + of[2].part) + of[3].part)
    lanes end = y.V + s * SUM(rate, V);
    lanes slip = all(0);
    mask turned = mode.direction * end < 0;
    if (any(turned)) { /* friction of the other sign for what is left of the step, or rest */
        lanes left = h * end / (end - y.V);
        lanes after = mode.direction * least(all(0), mode.direction * end + 2 * c[A_F] * left);
        slip = where(turned, 0.5 * left * (after - end), slip);
        end = where(turned, after, end);
    }
    return (State){y.Z + s * SUM(rate, Z) - c[R_Z] * slip,
                   y.Q + s * SUM(at, Q1),
                   y.Q1 + s * SUM(rate, Q1),
                   y.X + s * SUM(at, V) + slip,
                   end,
                   y.D + s * SUM(at, D1),
                   y.D1 + s * SUM(rate, D1)};
}

static inline void advance(State *y, int pushing, double h, const lanes (*c)[ROWS]) {
    const double nodes[] = {0, 0.5 * h, 0.5 * h, h};
    Mode mode[GROUPS];
    State at[GROUPS][4];
    Rates rate[GROUPS][4];
    EACH mode[j] = mode_at(y[j], pushing ? c[j][F] : all(0), c[j]);
#pragma GCC unroll 4
    for (int stage = 0; stage < 4; stage++) {
        EACH {
            at[j][stage] = stage ? moved(y[j], all(nodes[stage]), at[j][stage - 1], rate[j][stage - 1]) : y[j];
            rate[j][stage] = derivative(at[j][stage], mode[j].push, mode[j].moving, c[j]);
        }
    }
    EACH y[j] = landed(y[j], at[j], rate[j], mode[j], h, c[j]);
}

/* coefficients: groups of ROWS * LANES; theta: groups of OUTPUTS * LANES, aligned to 64 bytes; groups even. */
void simulate(long groups, const lanes (*coefficients)[ROWS], lanes (*theta)[OUTPUTS]) {
    const double h = 1e-3 * OUTPUTS_PER_STEP;
    for (long group = 0; group < groups; group += GROUPS, coefficients += GROUPS, theta += GROUPS) {
        State y[GROUPS] = {};
        EACH theta[j][0] = y[j].X;
        for (int n = 0; n < OUTPUTS - 1; n += OUTPUTS_PER_STEP) {
            lanes X[GROUPS], V[GROUPS];
            EACH X[j] = y[j].X, V[j] = y[j].V;
            advance(y, n >= STEP_OUTPUT, h, coefficients);
            EACH {
                lanes angle = coefficients[j][THETA];
                if (OUTPUTS_PER_STEP == 2)
                    theta[j][n + 1] = angle * (0.5 * (X[j] + y[j].X) + 0.125 * h * (V[j] - y[j].V));
                theta[j][n + OUTPUTS_PER_STEP] = angle * y[j].X;
            }
        }
    }
}
