// The multiply-add peak of one core: enough independent accumulators to hide the latency, and no memory.
#include <algorithm>
#include <chrono>
#include <cstdio>

namespace {

constexpr long ROUNDS = 200'000;
constexpr int REPEATS = 500;

// Accumulators as members one by one: the compiler keeps an array of them in memory.
template <class Number, int BYTES, int COUNT>
struct Accumulators {
    typedef Number Vector __attribute__((vector_size(BYTES)));
    Vector sum;
    Accumulators<Number, BYTES, COUNT - 1> others;

    __attribute__((always_inline)) void begin(Number b) {
        sum = Vector{} + b * COUNT;
        others.begin(b);
    }
    __attribute__((always_inline)) void go_on(Vector a, Vector b) {
        sum = sum * a + b;
        asm volatile("" : "+v"(sum));
        others.go_on(a, b);
    }
};

template <class Number, int BYTES>
struct Accumulators<Number, BYTES, 0> {
    void begin(Number) {}
    template <class Vector>
    void go_on(Vector, Vector) {}
};

// The best of REPEATS, in 10⁹ operations in a second.
template <class Number, int BYTES, int COUNT>
double rate(Number factor, Number addend) {
    using Sums = Accumulators<Number, BYTES, COUNT>;
    const typename Sums::Vector a = typename Sums::Vector{} + factor, b = typename Sums::Vector{} + addend;
    double best = 0;
    for (int repeat = 0; repeat < REPEATS; repeat++) {
        Sums sums;
        sums.begin(addend);
        const auto start = std::chrono::steady_clock::now();
        for (long round = 0; round < ROUNDS; round++) sums.go_on(a, b);
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
        const double operations = 2.0 * ROUNDS * COUNT * (BYTES / sizeof(Number));
        best = std::max(best, operations / seconds.count() * 1e-9);
    }
    return best;
}

}  // namespace

int main(int argc, char**) {
    const double factor = 0.5 / argc, addend = argc;
    std::printf("{\"f64 256-bit\": %.6g, \"f32 256-bit\": %.6g", rate<double, 32, 12>(factor, addend),
                rate<float, 32, 12>(factor, addend));
#ifdef __AVX512F__
    std::printf(", \"f64 512-bit\": %.6g, \"f32 512-bit\": %.6g", rate<double, 64, 24>(factor, addend),
                rate<float, 64, 24>(factor, addend));
#endif
    std::puts("}");
}
