// What this processor can do at best: the distance curve of a template of 100 columns over a clip of
// 25,000 frames of 39 features, without starts, in 16-bit sums that are exact for whole weights only.
// Prints the facts of the curve, in disagreements, and the median of the process's CPU milliseconds.
// limit NAME RUNS JOB FILE: JOB is unit (every step weighs 1) or advance (a step that skips a column
//   weighs 2), FILE holds the words of the template and then those of the clip as u64.
//
// Lanes are template columns and stay in registers from frame to frame. A disagreement is counted for 64
// columns at a time in planes of a byte of the words.
#include <immintrin.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { COLUMNS = 100, FRAMES = 25000, PLANES = 5, HALVES = 2, VECTORS = 4, UNREACHED = 1 << 15 };
typedef struct {
    uint8_t value[PLANES][64 * HALVES], care[PLANES][64 * HALVES];
    uint16_t weight[32 * VECTORS];
} Template;

#define INLINE static inline __attribute__((always_inline))
#define EACH(name, n) _Pragma("GCC unroll 8") for (int name = 0; name < n; name++)

INLINE void curve(const Template *t, const uint64_t *clip, uint16_t *costs, int is_advance) {
    const __m512i unreached = _mm512_set1_epi16(UNREACHED), zero = _mm512_setzero_si512();
    const __m512i first = _mm512_mask_mov_epi16(unreached, 1, zero);
    // D(k, l-1), and D(k-1, l-2) moved over already when frame l begins.
    __m512i before[VECTORS], moved_before[VECTORS];
    EACH(v, VECTORS) before[v] = moved_before[v] = unreached;
    uint16_t __attribute__((aligned(64))) last[32];
    for (int l = 0; l < FRAMES; l++) {
        __m512i counts[HALVES], cost[VECTORS];
        EACH(h, HALVES) {
            counts[h] = zero;
            EACH(p, PLANES) {
                __m512i byte = _mm512_set1_epi8((char)(clip[l] >> 8 * p));
                __m512i value = _mm512_load_si512(t->value[p] + 64 * h);
                __m512i care = _mm512_load_si512(t->care[p] + 64 * h);
                // (byte ^ value) & care
                __m512i wrong = _mm512_ternarylogic_epi32(byte, value, care, 0x28);
                counts[h] = _mm512_add_epi8(counts[h], _mm512_popcnt_epi8(wrong));
            }
            cost[2 * h] = _mm512_cvtepu8_epi16(_mm512_castsi512_si256(counts[h]));
            cost[2 * h + 1] = _mm512_cvtepu8_epi16(_mm512_extracti64x4_epi64(counts[h], 1));
        }
        __m512i now[VECTORS], moved[VECTORS];
        EACH(v, VECTORS) {
            cost[v] = _mm512_mullo_epi16(cost[v], _mm512_load_si512(t->weight + 32 * v));
            __m512i left = v > 0 ? before[v > 0 ? v - 1 : 0] : unreached;
            // Two columns further, and one.
            __m512i skip = _mm512_alignr_epi32(before[v], left, 15);
            moved[v] = _mm512_shldi_epi32(before[v], skip, 16);
            if (is_advance) skip = _mm512_add_epi16(skip, cost[v]);
            __m512i best = _mm512_min_epu16(_mm512_min_epu16(moved[v], moved_before[v]), skip);
            // Column 0 begins anywhere.
            if (v == 0) best = _mm512_mask_mov_epi16(best, 1, first);
            now[v] = _mm512_add_epi16(best, cost[v]);
        }
        EACH(v, VECTORS) before[v] = now[v], moved_before[v] = moved[v];
        _mm512_store_si512(last, now[(COLUMNS - 1) / 32]);
        costs[l] = last[(COLUMNS - 1) % 32];
    }
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
    static uint64_t words[COLUMNS + FRAMES];
    static uint16_t costs[FRAMES];
    static Template __attribute__((aligned(64))) t;
    int runs = argc == 5 ? atoi(argv[2]) : 0;
    FILE *file = runs > 0 ? fopen(argv[4], "rb") : NULL;
    if (!file) return fprintf(stderr, "usage: limit NAME RUNS JOB FILE\n"), 2;
    if (fread(words, sizeof words, 1, file) != 1) return fprintf(stderr, "too short\n"), 2;
    for (int k = 0; k < COLUMNS; k++) {
        t.weight[k] = 1;
        for (int p = 0; p < PLANES; p++) t.value[p][k] = words[k] >> 8 * p, t.care[p][k] = 255;
    }
    int is_advance = strcmp(argv[3], "advance") == 0;
    double *times = malloc(runs * sizeof *times);
    for (int i = -1; i < runs; i++) {
        double start = cpu_ms();
        if (is_advance) curve(&t, words + COLUMNS, costs, 1);
        else curve(&t, words + COLUMNS, costs, 0);
        // Nobody has changed the words, but the compiler is not to know.
        __asm__ volatile("" : : "r"(words), "r"(&t), "r"(costs) : "memory");
        if (i >= 0) times[i] = cpu_ms() - start;
    }
    long sum = 0;
    int least = UNREACHED, end = 0;
    for (int l = 0; l < FRAMES; l++)
        if (costs[l] < UNREACHED) {
            sum += costs[l];
            if (costs[l] < least) least = costs[l], end = l;
        }
    qsort(times, runs, sizeof *times, by_size);
    printf("least=%d end=%d sum=%ld ms=%.6f\n", least, end, sum, times[runs / 2]);
}
