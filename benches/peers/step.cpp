// The batch in C++: a structure of arrays, blocks of rows that stay in the first cache for the whole run, and the step
// of all rows of a block as one loop that the compiler turns into vectors.
//
//     step textbook|polynomial|located THREADS REPEATS CHECKED < work
//
// `textbook` writes the orifice with one power, u = r^((γ−1)/γ), and every quotient as the equations have it; the power
// is libmvec's. `polynomial` writes it as √(1−r) g(r) with g fitted at the start, and merges the divisions. Both take
// sgn(v), slack and taut where the rates are evaluated. `located` is `polynomial` with the direction of sliding and the
// length_regime (slack, free, taut) held, and the few rows in which one of them ends inside a step taken again one by one: to
// that instant, and on with what holds from there.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace {

constexpr int LANES = 32;
constexpr int TERMS = 13;  // g to 1e-12

enum class Form { textbook, polynomial, located };

constexpr int TURNS = 4;             // in one step; the rest of it is then taken as it is
constexpr int SECANTS = 2;           // that find an instant, before the last
constexpr double FROM_REST = 1e-3;   // part of a step in which what has just begun is not asked whether it ends

struct Part {
    double time, step;
    int filling;
};

// What all rows share, with what follows from it.
struct Muscle {
    double square_thread, per_turns, effectiveness, min_length, max_length, external_volume;
    double viscous, coulomb_width, stiffness, damping;
    double gamma, gas_constant, atmosphere, temperature, gravity;
    double critical_ratio, laminar_ratio, laminar_slope, conductance, ratio_power, ratio_factor, scale, offset;
    std::array<double, TERMS> g;
};

struct alignas(64) Block {
    double length[LANES], velocity[LANES], pressure[LANES], air[LANES];
    double per_mass[LANES], supply[LANES];
    double sliding[LANES];  // -1, 0 (stuck) or 1
    double length_regime[LANES];   // -1 (slack), 0 or 1 (taut)
};

// What holds over a step of one row. In the loop over rows the two are passed one by one: a pair is no vector.
struct Held {
    double sliding, length_regime;
};

struct State {
    double length, velocity, pressure, air;
};

// Least and largest tension that friction can hold at rest.
struct Hold {
    double least, most;
};

struct Work {
    Muscle muscle;
    std::vector<Part> parts;
    std::vector<Block> blocks;
    size_t rows;
};

// Coefficients in rising powers of t in [-1, 1] of the polynomial through `f` at the Chebyshev points.
template <class F>
std::array<double, TERMS> fit(F f) {
    std::array<double, TERMS> value, series{}, power{}, last{}, now{};
    for (int n = 0; n < TERMS; n++) value[n] = f(std::cos(M_PI * (n + 0.5) / TERMS));
    for (int k = 0; k < TERMS; k++) {
        for (int n = 0; n < TERMS; n++) series[k] += value[n] * std::cos(M_PI * k * (n + 0.5) / TERMS);
        series[k] *= (k == 0 ? 1.0 : 2.0) / TERMS;
    }
    now[0] = 1.0;
    for (int k = 0; k < TERMS; k++) {
        for (int n = 0; n < TERMS; n++) power[n] += series[k] * now[n];
        std::array<double, TERMS> next{};
        for (int n = 0; n + 1 < TERMS; n++) next[n + 1] = (k == 0 ? 1.0 : 2.0) * now[n];
        for (int n = 0; n < TERMS; n++) next[n] -= last[n];
        last = now, now = next;
    }
    return power;
}

Muscle prepare(std::map<std::string, double> number) {
    Muscle m{};
    const double b = number["thread_length"], n = number["turns"], gamma = number["gamma"], R = number["gas_constant"];
    m.square_thread = b * b, m.per_turns = 1 / (4 * M_PI * n * n), m.effectiveness = number["effectiveness"];
    m.min_length = number["min_length"], m.max_length = number["max_length"];
    m.external_volume = number["external_volume"];
    m.viscous = number["viscous"], m.coulomb_width = number["coulomb_width"];
    m.stiffness = number["stiffness"], m.damping = number["damping"];
    m.gamma = gamma, m.gas_constant = R, m.atmosphere = number["atmosphere"];
    m.temperature = number["temperature"], m.gravity = number["gravity"];
    const double base = 2 / (gamma + 1), choked = std::pow(base, (gamma + 1) / (gamma - 1));
    m.critical_ratio = std::pow(base, gamma / (gamma - 1)), m.laminar_ratio = number["laminar_ratio"];
    m.conductance = number["area"] * std::sqrt(gamma / R * choked);
    m.ratio_power = (gamma - 1) / gamma, m.ratio_factor = 2 / ((gamma - 1) * choked);
    const auto psi = [&](double r) {
        return std::sqrt(m.ratio_factor * std::pow(r, 2 / gamma) * -std::expm1(m.ratio_power * std::log(r)));
    };
    m.laminar_slope = psi(m.laminar_ratio) / (1 - m.laminar_ratio);
    const double middle = (m.laminar_ratio + m.critical_ratio) / 2, half = (m.laminar_ratio - m.critical_ratio) / 2;
    m.scale = 1 / half, m.offset = -middle / half;
    m.g = fit([&](double t) {
        const double r = middle + half * t;
        return psi(r) / std::sqrt(1 - r);
    });
    return m;
}

// ψ of the pressure ratio: 1 when choked, the orifice, and the straight line.
template <Form FORM>
inline __attribute__((always_inline)) double psi(const Muscle& m, double r) {
    const double kept = std::min(std::max(r, m.critical_ratio), m.laminar_ratio);
    double orifice;
    if constexpr (FORM == Form::textbook) {
        const double u = std::pow(kept, m.ratio_power);  // r^(2/γ) = u^(2/(γ−1)), which is u⁵ for γ = 1.4
        const double powers = m.gamma == 1.4 ? u * u * u * u * u : std::pow(kept, 2 / m.gamma);
        orifice = std::sqrt(m.ratio_factor * powers * (1 - u));
    } else {
        const double t = m.scale * kept + m.offset, t2 = t * t, t4 = t2 * t2;
        const auto& g = m.g;
        const double low = (g[0] + g[1] * t) + t2 * (g[2] + g[3] * t);
        const double middle = (g[4] + g[5] * t) + t2 * (g[6] + g[7] * t);
        const double high = (g[8] + g[9] * t) + t2 * (g[10] + g[11] * t) + t4 * g[12];
        orifice = std::sqrt(1 - kept) * (low + t4 * (middle + t4 * high));
    }
    return r > m.laminar_ratio ? m.laminar_slope * (1 - r) : orifice;
}

template <Form FORM, bool FILLING>
inline __attribute__((always_inline)) State rates(const Muscle& m, double per_mass, double supply, double sliding,
                                                  double length_regime, const State& y) {
    const double L = y.length, P = y.pressure, air = y.air;
    const bool stuck = FORM == Form::located && sliding == 0;
    const double v = stuck ? 0.0 : y.velocity;
    const double length = std::max(L, m.min_length);
    const double gauge = P - m.atmosphere, square = length * length;
    const double slope = (m.square_thread - 3 * square) * m.per_turns;
    const double volume = length * (m.square_thread - square) * m.per_turns + m.external_volume;
    const double secant = 3 * gauge * (length + m.min_length) * m.per_turns * m.effectiveness;
    const double stretched = m.stiffness * (L - m.max_length) + m.damping * v;
    const double taut = FORM == Form::located ? (length_regime > 0 ? stretched : 0.0)
                                              : (L > m.max_length ? std::max(stretched, 0.0) : 0.0);
    const double friction = m.coulomb_width * std::max(secant, 0.0);
    const double coulomb = FORM == Form::located ? sliding * friction : v > 0 ? friction : v < 0 ? -friction : 0.0;
    const double force = std::max(taut + m.viscous * v + coulomb - m.effectiveness * gauge * slope, 0.0);
    const bool slack = FORM == Form::located ? length_regime < 0 : L < m.min_length;
    const double tension = slack ? 0.0 : force, volume_rate = slack ? 0.0 : slope * v;

    const double beyond = FILLING ? supply : m.atmosphere;
    const double high = std::max(P, beyond), low = std::min(P, beyond);
    double drive, flow, rate;
    if constexpr (FORM == Form::textbook) {
        const double temperature = P < beyond ? m.temperature : P * volume / (air * m.gas_constant);
        drive = high / std::sqrt(temperature);
        flow = m.conductance * drive * psi<FORM>(m, low / high);
        flow = P < beyond ? flow : -flow;
        rate = m.gamma * P * (flow / air - volume_rate / volume);
    } else {
        const double per_content = 1 / (air * volume);
        const double outward = P * m.gas_constant * air * air * per_content;
        const double inward = high * high * (1 / m.temperature);
        drive = std::sqrt(P < beyond ? inward : outward);
        flow = m.conductance * drive * psi<FORM>(m, low / high);
        flow = P < beyond ? flow : -flow;
        rate = m.gamma * P * (flow * volume - volume_rate * air) * per_content;
    }
    return {v, stuck ? 0.0 : m.gravity - tension * per_mass, rate, flow};
}

// One step of the classical Runge-Kutta method.
template <Form FORM, bool FILLING>
inline __attribute__((always_inline)) State step(const Muscle& m, double per_mass, double supply, double sliding,
                                                 double length_regime, const State& y, double h) {
    const auto slope = [&](const State& at) __attribute__((always_inline)) {
        return rates<FORM, FILLING>(m, per_mass, supply, sliding, length_regime, at);
    };
    const auto ahead = [&](const State& k, double by) __attribute__((always_inline)) {
        return State{y.length + by * k.length, y.velocity + by * k.velocity, y.pressure + by * k.pressure,
                     y.air + by * k.air};
    };
    const State a = slope(y), b = slope(ahead(a, 0.5 * h)), c = slope(ahead(b, 0.5 * h)), d = slope(ahead(c, h));
    return ahead({a.length + 2 * (b.length + c.length) + d.length,
                  a.velocity + 2 * (b.velocity + c.velocity) + d.velocity,
                  a.pressure + 2 * (b.pressure + c.pressure) + d.pressure, a.air + 2 * (b.air + c.air) + d.air},
                 h / 6);
}

inline __attribute__((always_inline)) Hold hold(const Muscle& m, double L, double P) {
    const double length = std::max(L, m.min_length), gauge = P - m.atmosphere;
    const double force = m.effectiveness * gauge * (3 * length * length - m.square_thread) * m.per_turns;
    const double middle = force + m.stiffness * std::max(L - m.max_length, 0.0);
    const double secant = 3 * gauge * (length + m.min_length) * m.per_turns * m.effectiveness;
    const double bound = m.coulomb_width * std::max(secant, 0.0);
    return {L <= m.min_length ? 0.0 : std::max(middle - bound, 0.0), std::max(middle + bound, 0.0)};
}

// Negative where the direction of sliding has ceased to hold.
inline __attribute__((always_inline)) double slides(const Muscle& m, double per_mass, double sliding, const State& y) {
    const double pull = m.gravity / per_mass;
    const Hold can = hold(m, y.length, y.pressure);
    return sliding == 0 ? std::min(can.most - pull, pull - can.least) : sliding * y.velocity;
}

// Negative where the length_regime has ceased to hold, as a force of the taut braid.
inline __attribute__((always_inline)) double extends(const Muscle& m, double length_regime, const State& y) {
    const double above = m.stiffness * (y.length - m.min_length), beyond = m.stiffness * (y.length - m.max_length);
    const double taut = std::min(beyond, beyond + m.damping * y.velocity);
    return length_regime < 0 ? -above : length_regime > 0 ? taut : std::min(above, -taut);
}

inline __attribute__((always_inline)) double lasts(const Muscle& m, double per_mass, double sliding, double length_regime,
                                                  const State& y) {
    return std::min(slides(m, per_mass, sliding, y), extends(m, length_regime, y));
}

double from_rest(const Muscle& m, double per_mass, const State& y) {
    if (y.length < m.min_length) return 1;
    const double pull = m.gravity / per_mass;
    const Hold can = hold(m, y.length, y.pressure);
    return pull > can.most ? 1 : pull < can.least ? -1 : 0;
}

// What holds from an instant at which the length_regime or the direction of sliding ended.
void pass(const Muscle& m, double per_mass, bool by_extent, Held& held, State& y) {
    if (by_extent) {
        const bool was_free = held.length_regime == 0, is_short = y.length < (m.min_length + m.max_length) / 2;
        held.length_regime = !was_free ? 0 : is_short ? -1 : 1;
    } else if (held.sliding != 0) {
        y.velocity = 0;
        held.sliding = from_rest(m, per_mass, y);
    } else {
        const Hold can = hold(m, y.length, y.pressure);
        const double pull = m.gravity / per_mass;
        held.sliding = can.most - pull < pull - can.least ? 1 : -1;
    }
}

// A step of one row in which something ends: to that instant by secants, and on from there.
template <bool FILLING>
State turn(const Muscle& m, double per_mass, double supply, Held& held, State y, double h) {
    const auto to = [&](double part) {
        return step<Form::located, FILLING>(m, per_mass, supply, held.sliding, held.length_regime, y, part * h);
    };
    for (int count = 0; count < TURNS; count++) {
        const State end = to(1);
        // What holds at the end is taken to hold throughout; of two that do not, the one nearer to its end goes first.
        const bool ends[] = {slides(m, per_mass, held.sliding, end) < 0, extends(m, held.length_regime, end) < 0};
        if (!ends[0] && !ends[1]) return end;
        bool by_extent = false;
        const auto value = [&](const State& at) {
            const double sliding = ends[0] ? slides(m, per_mass, held.sliding, at) : 1e300;
            const double length_regime = ends[1] ? extends(m, held.length_regime, at) : 1e300;
            by_extent = length_regime < sliding;
            return std::min(sliding, length_regime);
        };
        double low = 0, high = 1, at_low = value(y), at_high = value(end), part = FROM_REST;
        if (at_low <= 0) low = FROM_REST, at_low = value(to(FROM_REST));
        if (at_low > 0) {
            for (int n = 0; n < SECANTS; n++) {
                part = low + (high - low) * at_low / (at_low - at_high);
                const double here = value(to(part));
                (here > 0 ? low : high) = part;
                (here > 0 ? at_low : at_high) = here;
            }
            part = low + (high - low) * at_low / (at_low - at_high);
        }
        y = to(part);
        h *= 1 - part;
        pass(m, per_mass, by_extent, held, y);
    }
    return to(1);
}

template <Form FORM, bool FILLING>
void step(const Muscle& muscle, Block& block, double h) {
    const Muscle m = muscle;
    Block next;
    double least = 1;
#pragma omp simd simdlen(8) reduction(min : least)
    for (int i = 0; i < LANES; i++) {
        const State y{block.length[i], block.velocity[i], block.pressure[i], block.air[i]};
        const double per_mass = block.per_mass[i];
        const double sliding = block.sliding[i], length_regime = block.length_regime[i];
        const State end = step<FORM, FILLING>(m, per_mass, block.supply[i], sliding, length_regime, y, h);
        if constexpr (FORM == Form::located) least = std::min(least, lasts(m, per_mass, sliding, length_regime, end));
        next.length[i] = end.length, next.velocity[i] = end.velocity;
        next.pressure[i] = end.pressure, next.air[i] = end.air;
    }
    if (FORM == Form::located && least < 0) {
        for (int i = 0; i < LANES; i++) {
            const double per_mass = block.per_mass[i];
            State end{next.length[i], next.velocity[i], next.pressure[i], next.air[i]};
            Held held{block.sliding[i], block.length_regime[i]};
            if (lasts(m, per_mass, held.sliding, held.length_regime, end) >= 0) continue;
            const State y{block.length[i], block.velocity[i], block.pressure[i], block.air[i]};
            end = turn<FILLING>(m, per_mass, block.supply[i], held, y, h);
            block.sliding[i] = held.sliding, block.length_regime[i] = held.length_regime;
            next.length[i] = end.length, next.velocity[i] = end.velocity;
            next.pressure[i] = end.pressure, next.air[i] = end.air;
        }
    }
    std::copy_n(next.length, LANES, block.length);
    std::copy_n(next.velocity, LANES, block.velocity);
    std::copy_n(next.pressure, LANES, block.pressure);
    std::copy_n(next.air, LANES, block.air);
}

template <Form FORM>
void run(const Muscle& muscle, const std::vector<Part>& parts, std::vector<Block>& blocks, int threads) {
#pragma omp parallel for num_threads(threads) schedule(static)
    for (size_t n = 0; n < blocks.size(); n++) {
        Block block = blocks[n];
        for (const Part& part : parts) {
            if (part.filling) {
                step<FORM, true>(muscle, block, part.step);
            } else {
                step<FORM, false>(muscle, block, part.step);
            }
        }
        blocks[n] = block;
    }
}

Work read() {
    Work work;
    std::map<std::string, double> number;
    std::string name;
    size_t count = 0;
    while (std::cin >> name && name != "parts") std::cin >> number[name];
    std::cin >> count;
    work.parts.resize(count);
    for (Part& part : work.parts) std::cin >> part.time >> part.step >> part.filling;
    std::cin >> name >> work.rows;
    work.muscle = prepare(number);
    // The last block is filled up with copies of its last row.
    work.blocks.resize((work.rows + LANES - 1) / LANES);
    double mass, supply, length, velocity, pressure, air;
    for (size_t n = 0; n < work.blocks.size() * LANES; n++) {
        if (n < work.rows) std::cin >> mass >> supply >> length >> velocity >> pressure >> air;
        Block& block = work.blocks[n / LANES];
        const size_t i = n % LANES;
        block.per_mass[i] = 1 / mass, block.supply[i] = supply, block.length[i] = length;
        block.velocity[i] = velocity, block.pressure[i] = pressure, block.air[i] = air;
        const bool moves = velocity != 0;
        block.sliding[i] = moves ? std::copysign(1, velocity)
                                 : from_rest(work.muscle, 1 / mass, {length, velocity, pressure, air});
        block.length_regime[i] = length < work.muscle.min_length ? -1 : length > work.muscle.max_length ? 1 : 0;
    }
    return work;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 5) return std::fputs("step textbook|polynomial|located THREADS REPEATS CHECKED < work\n", stderr), 2;
    const std::string_view form(argv[1]);
    const int threads = std::atoi(argv[2]), repeats = std::atoi(argv[3]);
    const Work work = read();
    const auto solve = form == "textbook" ? run<Form::textbook>
                       : form == "located" ? run<Form::located>
                                           : run<Form::polynomial>;
    std::vector<Block> blocks;
    double best = std::numeric_limits<double>::infinity();
    for (int repeat = 0; repeat < repeats; repeat++) {
        blocks = work.blocks;
        const auto start = std::chrono::steady_clock::now();
        solve(work.muscle, work.parts, blocks, threads);
        best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    std::printf("{\"seconds\": %.9g, \"states\": [", best);
    const size_t checked = std::min(work.rows, static_cast<size_t>(std::atoi(argv[4])));
    for (size_t n = 0; n < checked; n++) {
        const Block& block = blocks[n / LANES];
        const size_t i = n % LANES;
        std::printf("%s[%.17g, %.17g, %.17g, %.17g]", n ? ", " : "", block.length[i], block.velocity[i],
                    block.pressure[i], block.air[i]);
    }
    std::puts("]}");
}
