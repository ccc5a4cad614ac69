// What this processor can do at best. Prints a sum of what was read and the median of the process's
// CPU milliseconds. Results go to the same memory each time.
// limit sse-numbers RUNS FILE: decimal text, separated by single blanks or newlines, to doubles,
//   exactly, sixteen bytes at a time; fails unless each number is what strtod makes of it.
// limit copy-points RUNS FILE: the float points of a C3D to positions, residuals and cameras.
#include <immintrin.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { LANES = 16 };

// Powers of ten up to the number of digits that fit into one load; all are exact doubles.
static const double TEN[LANES] = {1e0, 1e1, 1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                  1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};

// Shuffles by length of the word and place of its point: digits moved to the right end, point left out.
static uint8_t digits_right[LANES + 1][LANES + 1][LANES];

static void fill_shuffles(void) {
    for (int length = 0; length <= LANES; length++)
        for (int point = 0; point <= LANES; point++) {
            uint8_t *shuffle = digits_right[length][point];
            memset(shuffle, 0x80, LANES);
            for (int from = length - 1, to = LANES - 1; from >= 0; from--)
                if (from != point) shuffle[to--] = (uint8_t)from;
        }
}

// Returns how many numbers it read. LANES readable bytes must follow the text.
static size_t read_numbers(const char *text, size_t n_bytes, double *out) {
    const __m128i first = _mm_setr_epi8('0', 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0);
    const __m128i tens = _mm_setr_epi8(10, 1, 10, 1, 10, 1, 10, 1, 10, 1, 10, 1, 10, 1, 10, 1);
    const __m128i hundreds = _mm_setr_epi16(100, 1, 100, 1, 100, 1, 100, 1);
    const __m128i myriads = _mm_setr_epi16(10000, 1, 10000, 1, 10000, 1, 10000, 1);
    const __m128i blank = _mm_set1_epi8(' ');
    const char *end = text + n_bytes;
    size_t n = 0;
    while (text < end) {
        __m128i bytes = _mm_loadu_si128((const __m128i *)text);
        unsigned blanks = _mm_movemask_epi8(_mm_cmpeq_epi8(_mm_max_epu8(bytes, blank), blank));
        unsigned points = _mm_movemask_epi8(_mm_cmpeq_epi8(bytes, _mm_set1_epi8('.')));
        int length = __builtin_ctz(blanks | 1u << LANES);
        int point = __builtin_ctz(points | 1u << length);
        // A sign in front becomes a leading zero.
        __m128i digits = _mm_sub_epi8(_mm_max_epu8(bytes, first), _mm_set1_epi8('0'));
        digits = _mm_shuffle_epi8(digits, _mm_loadu_si128((const __m128i *)digits_right[length][point]));
        __m128i too_big = _mm_subs_epu8(digits, _mm_set1_epi8(9));
        if (__builtin_expect(length == LANES || length == 0 || !_mm_testz_si128(too_big, too_big), 0)) {
            if (length == 0) {
                text++;
                continue;
            }
            char *rest;
            out[n++] = strtod(text, &rest);
            if (rest == text) return n - 1;
            text = rest;
            continue;
        }
        __m128i sums = _mm_madd_epi16(_mm_maddubs_epi16(digits, tens), hundreds);
        sums = _mm_madd_epi16(_mm_packus_epi32(sums, sums), myriads);
        uint64_t halves = (uint64_t)_mm_cvtsi128_si64(sums);
        uint64_t mantissa = (halves & 0xffffffff) * 100000000u + (halves >> 32);
        // At most 15 digits, so mantissa and power are exact and one division rounds once.
        double value = (double)(int64_t)mantissa / TEN[point < length ? length - point - 1 : 0];
        uint64_t bits;
        memcpy(&bits, &value, sizeof bits);
        bits |= (uint64_t)(*text == '-') << 63;
        memcpy(&out[n++], &bits, sizeof bits);
        text += length + 1;
    }
    return n;
}

static double cpu_ms(void) {
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return now.tv_sec * 1e3 + now.tv_nsec * 1e-6;
}

static int by_size(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

typedef struct {
    float x, y, z, cameras_and_residual;
} Point;

static void read_points(const Point *points, size_t n, float *positions, float *residuals, uint8_t *cameras) {
    for (size_t i = 0; i < n; i++) {
        positions[3 * i] = points[i].x;
        positions[3 * i + 1] = points[i].y;
        positions[3 * i + 2] = points[i].z;
        int word = (int)points[i].cameras_and_residual;
        residuals[i] = 0.1f * (word & 0xff);
        cameras[i] = (uint8_t)(word >> 8);
    }
}

static void *memory(size_t n_bytes) {
    void *block = malloc(n_bytes);
    if (!block) exit(2);
    return block;
}

static double time_numbers(const char *text, size_t n_bytes, int runs, double *times) {
    // A number takes at least two bytes with what separates it.
    double *out = memory((n_bytes / 2 + 1) * sizeof *out);
    fill_shuffles();
    size_t n = read_numbers(text, n_bytes, out);
    double sum = 0;
    char *at = (char *)text;
    for (size_t i = 0; i < n; i++) {
        double expected = strtod(at, &at);
        if (memcmp(&expected, &out[i], sizeof expected)) {
            fprintf(stderr, "number %zu differs\n", i);
            exit(1);
        }
        sum += out[i];
    }
    for (int i = 0; i < runs; i++) {
        double start = cpu_ms();
        read_numbers(text, n_bytes, out);
        times[i] = cpu_ms() - start;
    }
    return sum;
}

static double time_points(const char *bytes, size_t n_bytes, int runs, double *times) {
    const Point *points = (const Point *)bytes;
    size_t n = n_bytes / sizeof *points;
    float *positions = memory(3 * n * sizeof *positions), *residuals = memory(n * sizeof *residuals);
    uint8_t *cameras = memory(n);
    read_points(points, n, positions, residuals, cameras);
    double sum = 0;
    for (size_t i = 0; i < 3 * n; i++) sum += positions[i];
    for (int i = 0; i < runs; i++) {
        double start = cpu_ms();
        read_points(points, n, positions, residuals, cameras);
        // Nobody looks at the results again, yet they must be there.
        __asm__ volatile("" : : "r"(positions), "r"(residuals), "r"(cameras) : "memory");
        times[i] = cpu_ms() - start;
    }
    return sum;
}

int main(int argc, char **argv) {
    int runs = argc == 4 ? atoi(argv[2]) : 0;
    FILE *file = runs > 0 ? fopen(argv[3], "rb") : NULL;
    if (!file) return fprintf(stderr, "usage: limit NAME RUNS FILE\n"), 2;
    fseek(file, 0, SEEK_END);
    size_t n_bytes = (size_t)ftell(file);
    rewind(file);
    char *bytes = memory(n_bytes + LANES);
    if (fread(bytes, 1, n_bytes, file) != n_bytes) return 2;
    memset(bytes + n_bytes, ' ', LANES);

    double *times = memory(runs * sizeof *times);
    int is_points = strcmp(argv[1], "copy-points") == 0;
    double sum = (is_points ? time_points : time_numbers)(bytes, n_bytes, runs, times);
    qsort(times, runs, sizeof *times, by_size);
    printf("sum=%.17g ms=%.6f\n", sum, times[runs / 2]);
}
