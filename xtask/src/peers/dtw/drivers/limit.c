// What this processor can do at best: dynamic time warping of two sequences of 1000 frames and 62
// dimensions in f32, without band or path. Prints its cost and the median of the process's CPU
// milliseconds.
// limit NAME RUNS JOB FILE: JOB is multi (sum of Euclidean local costs) or multi-squared (root of the
//   sum of their squares), FILE holds both sequences as f32, frame after frame.
//
// Rows go in strips of two vectors; lane r stands r columns behind lane 0 and the second vector a whole
// vector behind the first, so that all cells of a step are independent of each other. Local costs are
// |a|^2 + |b|^2 - 2ab, for a few columns at a time in registers. Between their multiplications stands the
// recurrence of the columns before, whose latency they hide.
#include <immintrin.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { FRAMES = 1000, DIMS = 62 };

#ifdef __AVX512F__
// COLUMNS accumulators for either vector, the state of the recurrence and operands fill the registers.
enum { LANES = 16, COLUMNS = 6 };
typedef __m512 Vec;
#define OP(name) _mm512_##name##_ps
#define FROM_LANE(mask, early, late) _mm512_mask_blend_ps(mask, early, late)
#define DELAYS(STEP) STEP(8, 0xFF00) STEP(4, 0xF0F0) STEP(2, 0xCCCC) STEP(1, 0xAAAA)
// Lanes move up by one; the last lane of `low` comes in.
#define MOVE_UP(low, high) \
    (Vec) _mm512_alignr_epi32((__m512i)(high), (__m512i)(low), LANES - 1)
#else
enum { LANES = 8, COLUMNS = 5 };
typedef __m256 Vec;
#define OP(name) _mm256_##name##_ps
#define FROM_LANE(mask, early, late) _mm256_blend_ps(early, late, mask)
#define DELAYS(STEP) STEP(4, 0xF0) STEP(2, 0xCC) STEP(1, 0xAA)
#define MOVE_UP(low, high) __builtin_shufflevector(low, high, 7, 8, 9, 10, 11, 12, 13, 14)
#endif
#define INLINE static inline __attribute__((always_inline))

// RING columns are remembered; a power of two above LANES. GROUP dimensions go by between two steps.
enum { ROWS = 2 * LANES, RING = 2 * LANES, GROUP = DIMS / COLUMNS, DELAY_STEPS = 5 };

typedef struct {
    Vec costs[2][COLUMNS];
    Vec rings[2][DELAY_STEPS][RING];
    Vec before[2], above[2];
} Strip;

// One step in time: D of lane r of the first vector at column t - r, of the second a vector later.
INLINE void step(Strip *s, int t, int g, float above, int is_euclidean) {
    Vec cost[2];
#pragma GCC unroll 2
    for (int v = 0; v < 2; v++) {
        Vec x = s->costs[v][g];
        if (is_euclidean) x = OP(sqrt)(OP(max)(x, OP(setzero)()));
        int stage = 0;
#define DELAY(by, mask)                                                  \
    s->rings[v][stage][t & (RING - 1)] = x;                              \
    x = FROM_LANE(mask, x, s->rings[v][stage++][(t - by) & (RING - 1)]);
        DELAYS(DELAY)
        cost[v] = x;
    }
    s->rings[1][DELAY_STEPS - 1][t & (RING - 1)] = cost[1];
    cost[1] = s->rings[1][DELAY_STEPS - 1][(t - LANES) & (RING - 1)];
    Vec up[2] = {MOVE_UP(OP(set1)(above), s->before[0]), MOVE_UP(s->before[0], s->before[1])};
#pragma GCC unroll 2
    for (int v = 0; v < 2; v++) {
        Vec best = OP(min)(up[v], OP(min)(s->above[v], s->before[v]));
        s->above[v] = up[v];
        s->before[v] = OP(add)(best, cost[v]);
    }
}

INLINE float norm(const float *frame) {
    float lanes[16] = {0}, sum = 0;
    for (int k = 0; k < DIMS; k++) lanes[k % 16] += frame[k] * frame[k];
    for (int k = 0; k < 16; k++) sum += lanes[k];
    return sum;
}

INLINE double dtw(const float *a, const float *b, int is_euclidean) {
    static float row[FRAMES + ROWS + COLUMNS], norms[FRAMES + COLUMNS];
    static float __attribute__((aligned(64))) rows[DIMS][ROWS], row_norms[ROWS];
    const Vec infinite = OP(set1)(INFINITY);
    float __attribute__((aligned(64))) last[ROWS] = {0};
    for (int j = 0; j < FRAMES; j++) norms[j] = norm(b + DIMS * j), row[j] = INFINITY;
    float corner = 0;
    for (int first = 0; first < FRAMES; first += ROWS) {
        int n_rows = FRAMES - first < ROWS ? FRAMES - first : ROWS;
        for (int r = 0; r < n_rows; r++) {
            const float *frame = a + DIMS * (first + r);
            row_norms[r] = norm(frame);
            for (int k = 0; k < DIMS; k++) rows[k][r] = -2 * frame[k];
        }
        Strip s;
        for (int v = 0; v < 2; v++) {
            for (int i = 0; i < DELAY_STEPS; i++)
                for (int t = 0; t < RING; t++) s.rings[v][i][t] = infinite;
            s.before[v] = s.above[v] = infinite;
            for (int c = 0; c < COLUMNS; c++) s.costs[v][c] = infinite;
        }
        s.above[0] = MOVE_UP(OP(set1)(corner), infinite);
        corner = INFINITY;
        int end = FRAMES - 1 + n_rows;
        for (int j = 0; j < end + COLUMNS; j += COLUMNS) {
            // Past the last column costs do not matter; those of the last ones are computed again.
            const float *frames = b + DIMS * (j < FRAMES ? j : FRAMES - COLUMNS);
            const float *own = norms + (j < FRAMES ? j : FRAMES - COLUMNS);
            Vec sums[2][COLUMNS];
#define MULTIPLY(k)                                                              \
    {                                                                            \
        Vec low = OP(load)(rows[k]), high = OP(load)(rows[k] + LANES);           \
        _Pragma("GCC unroll 16") for (int c = 0; c < COLUMNS; c++) {             \
            Vec other = OP(set1)(frames[DIMS * c + (k)]);                        \
            sums[0][c] = OP(fmadd)(low, other, sums[0][c]);                      \
            sums[1][c] = OP(fmadd)(high, other, sums[1][c]);                     \
        }                                                                        \
    }
            Vec low = OP(load)(row_norms), high = OP(load)(row_norms + LANES);
#pragma GCC unroll 16
            for (int c = 0; c < COLUMNS; c++) {
                Vec other = OP(set1)(own[c]);
                sums[0][c] = OP(add)(low, other);
                sums[1][c] = OP(add)(high, other);
            }
            for (int g = 0; g < COLUMNS; g++) {
#pragma GCC unroll 16
                for (int k = 0; k < GROUP; k++) MULTIPLY(GROUP * g + k)
                int t = j - COLUMNS + g;
                if (t < 0) continue;
                step(&s, t, g, row[t], is_euclidean);
                int column = t - (ROWS - 1);
                Vec down = MOVE_UP(s.before[1], s.before[1]);
                if (column >= 0) row[column] = ((float *)&down)[0];
                if (t == end - 1) memcpy(last, s.before, sizeof last);
            }
#pragma GCC unroll 16
            for (int k = GROUP * COLUMNS; k < DIMS; k++) MULTIPLY(k)
            memcpy(s.costs, sums, sizeof sums);
        }
    }
    double cost = last[(FRAMES - 1) % ROWS];
    return is_euclidean ? cost : sqrt(cost);
}

static double cpu_ms(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return 1e3 * t.tv_sec + 1e-6 * t.tv_nsec;
}

static int by_size(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

int main(int argc, char **argv) {
    static float both[2][FRAMES * DIMS];
    int runs = argc == 5 ? atoi(argv[2]) : 0;
    FILE *file = runs > 0 ? fopen(argv[4], "rb") : NULL;
    if (!file) return fprintf(stderr, "usage: limit NAME RUNS JOB FILE\n"), 2;
    if (fread(both, sizeof both, 1, file) != 1) return fprintf(stderr, "too short\n"), 2;
    int is_euclidean = strcmp(argv[3], "multi") == 0;
    double *times = malloc(runs * sizeof *times), cost = 0;
    for (int i = -1; i < runs; i++) {
        double start = cpu_ms();
        cost = is_euclidean ? dtw(both[0], both[1], 1) : dtw(both[0], both[1], 0);
        // Nobody has changed the sequences, but the compiler is not to know.
        __asm__ volatile("" : : "r"(both) : "memory");
        if (i >= 0) times[i] = cpu_ms() - start;
    }
    qsort(times, runs, sizeof *times, by_size);
    printf("cost=%.9g ms=%.6f\n", cost, times[runs / 2]);
}
