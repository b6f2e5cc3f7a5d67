#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>
#include <stdexcept>

#include <knurl/measure/law.hpp>

namespace knurl::measure {

namespace {

/// Share of a time that may depend on the placement of code and data: smaller residuals favour no law.
constexpr double placement = 0.01;
constexpr double least_exponent = 0.05, most_exponent = 3;

double shape(Growth growth, double n, double exponent) {
    switch (growth) {
        case Growth::constant:
            return 0;
        case Growth::logarithmic:
            return std::log2(n);
        case Growth::linear:
            return n;
        case Growth::linearithmic:
            return n * std::log2(n);
        case Growth::power:
            return std::pow(n, exponent);
    }
    return 0;
}

struct Candidate {
    Law law;
    double residual = 0;  // sum of squared relative errors
};

double residual_of(const Law& law, std::span<const double> n, std::span<const double> y) {
    double sum = 0;
    for (std::size_t i = 0; i < n.size(); ++i) sum += std::pow(law(n[i]) / y[i] - 1, 2);
    return sum;
}

/// Least squares of 1 = base / y + factor g(n) / y. With `falling` the factor may be negative.
Candidate with_shape(Growth growth, double exponent, std::span<const double> n, std::span<const double> y,
                     bool falling = false) {
    double uu = 0, uv = 0, vv = 0, u1 = 0, v1 = 0;
    for (std::size_t i = 0; i < n.size(); ++i) {
        const double u = 1 / y[i], v = shape(growth, n[i], exponent) / y[i];
        uu += u * u;
        uv += u * v;
        vv += v * v;
        u1 += u;
        v1 += v;
    }
    Law law{.growth = growth, .base = u1 / uu, .factor = 0, .exponent = exponent};
    if (growth != Growth::constant) {
        const double determinant = uu * vv - uv * uv;
        law.base = (u1 * vv - v1 * uv) / determinant;
        law.factor = (uu * v1 - uv * u1) / determinant;
        if (law.base < 0) law = {.growth = growth, .base = 0, .factor = v1 / vv, .exponent = exponent};
        if (law.factor < 0 && !falling)
            law = {.growth = growth, .base = u1 / uu, .factor = 0, .exponent = exponent};
    }
    return {law, residual_of(law, n, y)};
}

Candidate best_power(std::span<const double> n, std::span<const double> y, bool falling) {
    const auto at = [&](double logarithm) {
        return with_shape(Growth::power, std::exp(logarithm), n, y, falling);
    };
    // Coarsely first, since there may be more than one minimum.
    constexpr int steps = 40;
    const double low = std::log(least_exponent), width = (std::log(most_exponent) - low) / steps;
    int best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i <= steps; ++i) {
        const double residual = at(low + i * width).residual;
        if (residual < least) best = i;
        least = std::min(least, residual);
    }
    constexpr double golden = 0.6180339887498949;
    double a = low + std::max(0, best - 1) * width, b = low + std::min(steps, best + 1) * width;
    for (int i = 0; i < 20; ++i) {
        const double c = b - golden * (b - a), d = a + golden * (b - a);
        (at(c).residual < at(d).residual ? b : a) = at(c).residual < at(d).residual ? d : c;
    }
    return at((a + b) / 2);
}

double bic(const Candidate& candidate, int parameters, std::size_t points) {
    const auto m = static_cast<double>(points);
    return m * std::log(candidate.residual / m + placement * placement) + parameters * std::log(m);
}

struct Choice {
    Law growing, constant;
    bool grows = false;  // the growing law rises and has the smaller BIC
    double rise = 0, exponent = 0;
    const Law& law() const { return grows ? growing : constant; }
};

double rise_of(const Law& law, std::span<const double> n) {
    return law(n.back()) / law(n.front()) - 1;
}

Choice choose(std::span<const double> n, std::span<const double> y) {
    Choice choice;
    const Candidate constant = with_shape(Growth::constant, 0, n, y);
    const Candidate power = best_power(n, y, false);
    Candidate best = power;
    double least = bic(power, 3, n.size());
    for (const Growth growth : {Growth::logarithmic, Growth::linear, Growth::linearithmic}) {
        const Candidate candidate = with_shape(growth, 0, n, y);
        const double value = bic(candidate, 2, n.size());
        if (value < least) best = candidate;
        least = std::min(least, value);
    }
    choice.growing = best.law;
    choice.constant = constant.law;
    choice.exponent = power.law.exponent;
    // A falling time also has a rise.
    choice.rise = best.law.factor > 0 ? rise_of(best.law, n)
                                      : rise_of(with_shape(Growth::logarithmic, 0, n, y, true).law, n);
    choice.grows = choice.rise > material && least < bic(constant, 1, n.size());
    return choice;
}

double median(std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    if (values.size() % 2 != 0) return *middle;
    return (*middle + *std::max_element(values.begin(), middle)) / 2;
}

void require_sound(std::span<const Point> points) {
    const auto refuse = [](const std::string& why) { throw std::invalid_argument("no law: " + why); };
    if (points.size() < least_points)
        refuse(std::to_string(points.size()) + " points, " + std::to_string(least_points) + " are needed");
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Point& point = points[i];
        if (!(point.n > (i == 0 ? 0 : points[i - 1].n))) refuse("the values are not positive and ascending");
        if (point.blocks.empty() || point.blocks.size() != points[0].blocks.size())
            refuse("the points have different numbers of blocks, or none");
        for (const double time : point.blocks)
            if (!(time > 0 && std::isfinite(time))) refuse("a time is not positive");
    }
}

}  // namespace

const char* name_of(Growth growth) {
    constexpr std::array names = {"O(1)", "O(log n)", "O(n)", "O(n log n)", "O(n^p)"};
    return names[static_cast<std::size_t>(growth)];
}

const char* name_of(Design design) {
    return design == Design::as_designed ? "as designed"
           : design == Design::worse     ? "worse than by design"
                                         : "undecided";
}

double Law::operator()(double n) const {
    return base + (growth == Growth::constant ? 0 : factor * shape(growth, n, exponent));
}

Fitted fit(std::span<const Point> points, const Bootstrap& how) {
    require_sound(points);
    std::vector<double> n, y(points.size()), some;
    for (const Point& point : points) n.push_back(point.n);
    const std::size_t blocks = points[0].blocks.size();
    const auto medians = [&](auto block_of) {
        for (std::size_t p = 0; p < points.size(); ++p) {
            some.clear();
            for (std::size_t i = 0; i < blocks; ++i) some.push_back(points[p].blocks[block_of(i)]);
            y[p] = median(some);
        }
    };
    const auto of_all = [](std::size_t i) { return i; };
    medians(of_all);
    const Choice chosen = choose(n, y);
    Fitted fitted;
    fitted.law = chosen.law();
    fitted.rise = chosen.rise;
    fitted.exponent = chosen.exponent;

    // `bootstrap` takes one figure at a time, with the same resampling for each.
    const auto interval = [&](auto figure) {
        return bootstrap(
            blocks, blocks,
            [&](std::span<const std::size_t> drawn, std::span<const std::size_t>) -> std::optional<double> {
                medians([&](std::size_t i) { return drawn[i]; });
                return figure();
            },
            how);
    };
    if (blocks >= least_blocks) {
        fitted.rise_interval = interval([&] { return choose(n, y).rise; });
        if (fitted.rise_interval->low <= material) fitted.law = chosen.constant;
        fitted.exponent_interval = interval([&] { return best_power(n, y, false).law.exponent; });
        const Law law = fitted.law;
        const auto refitted = [&] { return with_shape(law.growth, law.exponent, n, y).law; };
        fitted.base_interval = interval([&] { return refitted().base; });
        fitted.factor_interval = interval([&] { return refitted().factor; });
        std::mt19937_64 random(how.seed);
        std::uniform_int_distribution<std::size_t> any(0, blocks - 1);
        constexpr int drawings = 100;
        int same = 0;
        for (int i = 0; i < drawings; ++i) {
            std::vector<std::size_t> drawn(blocks);
            for (std::size_t& one : drawn) one = any(random);
            medians([&](std::size_t k) { return drawn[k]; });
            same += choose(n, y).law().growth == law.growth ? 1 : 0;
        }
        fitted.agreed = static_cast<double>(same) / drawings;
    }
    medians(of_all);
    for (std::size_t i = 0; i < n.size(); ++i)
        fitted.off = std::max(fitted.off, std::abs(y[i] / fitted.law(n[i]) - 1));
    return fitted;
}

Design judge(const Fitted& fitted, Growth design) {
    if (!fitted.rise_interval) return Design::undecided;
    if (fitted.rise_interval->high <= material) return Design::as_designed;
    if (design == Growth::constant)
        return fitted.rise_interval->low > material ? Design::worse : Design::undecided;
    const double most = design == Growth::logarithmic ? 0.3 : 1.1;
    if (fitted.law.growth <= design || fitted.exponent_interval->high <= most) return Design::as_designed;
    return fitted.exponent_interval->low > most ? Design::worse : Design::undecided;
}

std::string text_of(const Fitted& fitted) {
    const Law& law = fitted.law;
    std::array<char, 200> text{};
    const auto print = [&](const char* form, auto... values) {
        std::snprintf(text.data(), text.size(), form, values...);
        return std::string(text.data());
    };
    const auto within = [&](const std::optional<Interval>& interval) {
        return interval ? print(" [%.4g, %.4g]", interval->low, interval->high) : std::string();
    };
    if (law.growth == Growth::constant) return print("O(1): %.4g", law.base) + within(fitted.base_interval);
    std::string of_n = law.growth == Growth::logarithmic ? "log2 n"
                       : law.growth == Growth::linear    ? "n"
                       : law.growth == Growth::linearithmic
                           ? "n log2 n"
                           : print("n^%.2f", law.exponent) + within(fitted.exponent_interval);
    const std::string name =
        law.growth == Growth::power ? print("O(n^%.2f)", law.exponent) : name_of(law.growth);
    return name + print(": %.4g + %.4g ", law.base, law.factor) + of_n + within(fitted.factor_interval);
}

}  // namespace knurl::measure
