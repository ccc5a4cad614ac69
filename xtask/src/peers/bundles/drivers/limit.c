// What this processor can do at best: EM for isotropic Gaussians in f64, for 7,300 frames of 12
// dimensions and 250 clusters, from a given start. Prints the mean log-likelihood of a frame, what
// the means come to, and the CPU milliseconds of an iteration: of MANY iterations less FEW.
// limit NAME RUNS JOB FRAMES START: FRAMES holds the frames as f64, START weights, variances, means.
//
// Shapes are constants, so that every loop is unrolled. An iteration is two matrix products with
// y = (x, |x|^2, 1) and an exponential between them. The first product cannot be avoided; of the
// exponentials and of the second one only what is not nothing beside the frame's largest.
#include <immintrin.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { FRAMES = 7300, DIMS = 12, CLUSTERS = 250, MANY = 25, FEW = 5 };
#ifdef __AVX512F__
enum { LANES = 8, GROUP = 6 };
#else
enum { LANES = 4, GROUP = 4 };
#endif
typedef double Vec __attribute__((vector_size(8 * LANES)));
typedef long long Int __attribute__((vector_size(8 * LANES)));
// Rows hold x, |x|^2, 1 and fill whole vectors; blocks are of two vectors of frames.
enum { ROW = 16, BLOCK = 2 * LANES, BLOCKS = (FRAMES + BLOCK - 1) / BLOCK };
enum { GROUPS = (CLUSTERS + GROUP - 1) / GROUP, PADDED = GROUPS * GROUP, WIDTH = ROW / LANES };
#define INLINE static inline __attribute__((always_inline))
#define ALIGNED __attribute__((aligned(64)))
static const double LEAST = -80, FLOOR = 1e-6;

static double ALIGNED rows[BLOCKS * BLOCK][ROW], tiles[BLOCKS][DIMS + 1][BLOCK];
static double ALIGNED factors[GROUPS][DIMS + 2][GROUP], sums[PADDED][ROW];
static double weights[CLUSTERS], variances[CLUSTERS], means[CLUSTERS][DIMS], centre[DIMS];
static Vec exponents[PADDED][2], likely[PADDED * 2];
static int places[PADDED * 2];
static double mean_variance;

INLINE Vec splat(double x) { return x - (Vec){0}; }

INLINE Vec choose(Int mask, Vec a, Vec b) {
    return (Vec)((mask & (Int)a) | (~mask & (Int)b));
}

#ifdef __AVX512F__
INLINE int any(Int mask) { return _mm512_test_epi64_mask((__m512i)mask, (__m512i)mask) != 0; }
#else
INLINE int any(Int mask) { return _mm256_movemask_pd((__m256d)mask) != 0; }
#endif

// e^t for t between LEAST and 0.
INLINE Vec exponential(Vec t) {
    const double rounder = 6755399441055744.0;
    Vec sum = t * M_LOG2E + rounder, n = sum - rounder;
    Vec r = t - n * 0x1.62e42feep-1;
    r -= n * 1.9082149292705877e-10;
    Vec series = splat(1.0 / 6227020800);
    double terms[] = {479001600, 39916800, 3628800, 362880, 40320, 5040, 720, 120, 24, 6, 2, 1, 1};
#pragma GCC unroll 16
    for (int i = 0; i < 13; i++) series = series * r + 1 / terms[i];
    return series * (Vec)(((Int)sum << 52) + 0x3ff0000000000000LL);
}

static double iterate(void) {
    for (int k = 0; k < PADDED; k++) {
        double(*out)[GROUP] = factors[k / GROUP];
        int i = k % GROUP;
        for (int d = 0; d < DIMS + 2; d++) out[d][i] = d ? 0 : -INFINITY;
        if (k >= CLUSTERS) continue;
        double half = 0.5 / variances[k], square = 0;
        for (int d = 0; d < DIMS; d++) {
            square += means[k][d] * means[k][d];
            out[d + 1][i] = 2 * half * means[k][d];
        }
        out[DIMS + 1][i] = -half;
        out[0][i] = log(weights[k]) - DIMS / 2.0 * log(2 * M_PI * variances[k]) - half * square;
    }
    memset(sums, 0, sizeof sums);
    double log_likelihood = 0;
    for (int b = 0; b < BLOCKS; b++) {
        Vec largest[2] = {splat(-1e300), splat(-1e300)};
        for (int g = 0; g < GROUPS; g++) {
            Vec sum[GROUP][2];
#pragma GCC unroll 16
            for (int k = 0; k < GROUP; k++) sum[k][0] = sum[k][1] = splat(factors[g][0][k]);
#pragma GCC unroll 16
            for (int d = 0; d <= DIMS; d++) {
                const Vec *x = (const Vec *)tiles[b][d];
#pragma GCC unroll 16
                for (int k = 0; k < GROUP; k++) {
                    sum[k][0] += x[0] * factors[g][d + 1][k];
                    sum[k][1] += x[1] * factors[g][d + 1][k];
                }
            }
#pragma GCC unroll 16
            for (int k = 0; k < GROUP; k++)
#pragma GCC unroll 2
                for (int v = 0; v < 2; v++) {
                    exponents[g * GROUP + k][v] = sum[k][v];
                    largest[v] = choose(largest[v] > sum[k][v], largest[v], sum[k][v]);
                }
        }
        Vec total[2] = {splat(0), splat(0)}, least[2] = {largest[0] + LEAST, largest[1] + LEAST};
        int n = 0;
        for (int k = 0; k < CLUSTERS; k++)
#pragma GCC unroll 2
            for (int v = 0; v < 2; v++) {
                Vec exponent = exponents[k][v];
                Int is_likely = exponent > least[v];
                if (!any(is_likely)) continue;
                Vec t = exponent - largest[v];
                Vec e = exponential(choose(t > LEAST, t, splat(LEAST)));
                e = choose(is_likely, e, splat(0));
                total[v] += e;
                likely[n] = e;
                places[n++] = 2 * k + v;
            }
        for (int i = 0; i < n; i++) {
            int k = places[i] / 2, v = places[i] % 2;
            Vec share = likely[i] / total[v];
            Vec *out = (Vec *)sums[k];
#pragma GCC unroll 4
            for (int w = 0; w < WIDTH; w++) {
                Vec sum = out[w];
#pragma GCC unroll 16
                for (int lane = 0; lane < LANES; lane++)
                    sum += share[lane] * ((const Vec *)rows[b * BLOCK + v * LANES + lane])[w];
                out[w] = sum;
            }
        }
        for (int i = 0; i < BLOCK && b * BLOCK + i < FRAMES; i++)
            log_likelihood += largest[i / LANES][i % LANES] + log(total[i / LANES][i % LANES]);
    }
    for (int k = 0; k < CLUSTERS; k++) {
        double amount = sums[k][DIMS + 1], square = 0;
        for (int d = 0; d < DIMS; d++) {
            means[k][d] = sums[k][d] / amount;
            square += means[k][d] * means[k][d];
        }
        variances[k] = fmax((sums[k][DIMS] / amount - square) / DIMS, FLOOR * mean_variance);
        weights[k] = amount / FRAMES;
    }
    return log_likelihood / FRAMES;
}

static double cpu_ms(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return 1e3 * t.tv_sec + 1e-6 * t.tv_nsec;
}

// Weights, variances and means, as they were read.
static double start[CLUSTERS * (DIMS + 2)];

static double fit(int iterations, double *ms) {
    memcpy(weights, start, sizeof weights);
    memcpy(variances, start + CLUSTERS, sizeof variances);
    for (int k = 0; k < CLUSTERS; k++)
        for (int d = 0; d < DIMS; d++)
            means[k][d] = start[2 * CLUSTERS + k * DIMS + d] - centre[d];
    double from = cpu_ms(), last = 0;
    for (int i = 0; i < iterations; i++) last = iterate();
    *ms = cpu_ms() - from;
    return last;
}

static int by_size(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

int main(int argc, char **argv) {
    static double frames[FRAMES][DIMS];
    int runs = argc == 6 ? atoi(argv[2]) : 0;
    FILE *file = runs > 0 ? fopen(argv[4], "rb") : NULL, *given = file ? fopen(argv[5], "rb") : NULL;
    if (!given) return fprintf(stderr, "usage: limit NAME RUNS JOB FRAMES START\n"), 2;
    if (fread(frames, sizeof frames, 1, file) != 1 || fread(start, sizeof start, 1, given) != 1)
        return fprintf(stderr, "too short\n"), 2;
    for (int d = 0; d < DIMS; d++) {
        for (int f = 0; f < FRAMES; f++) centre[d] += frames[f][d] / FRAMES;
        for (int f = 0; f < FRAMES; f++) {
            double x = frames[f][d] - centre[d];
            rows[f][d] = tiles[f / BLOCK][d][f % BLOCK] = x;
            rows[f][DIMS] += x * x, rows[f][DIMS + 1] = 1;
        }
    }
    for (int f = 0; f < FRAMES; f++) {
        tiles[f / BLOCK][DIMS][f % BLOCK] = rows[f][DIMS];
        mean_variance += rows[f][DIMS] / FRAMES / DIMS;
    }
    double *times = malloc(runs * sizeof *times), last = 0, many, few;
    for (int i = 0; i < runs; i++) {
        fit(FEW, &few);
        last = fit(MANY, &many);
        times[i] = (many - few) / (MANY - FEW);
    }
    qsort(times, runs, sizeof *times, by_size);
    double spread = 0;
    for (int k = 0; k < CLUSTERS; k++)
        for (int d = 0; d < DIMS; d++) {
            double x = means[k][d] + centre[d];
            spread += weights[k] * x * x;
        }
    printf("log_likelihood=%.12g spread=%.12g ms=%.6f\n", last, spread, times[runs / 2]);
}
