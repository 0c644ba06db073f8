#include "configs/scene/person_size.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <utility>

namespace wade {

namespace {

// L, M and S of a height, cm, or a mass, kg.
struct Chart {
    double l, m, s;
};
struct Growth {
    Chart height, mass;
};

// Of 2 to 20 years, year by year.
constexpr std::array<Growth, 19> female_growth{{
    {{1.072, 85.0, 0.04079}, {-0.7353, 12.1, 0.1074}},    {{0.5608, 93.9, 0.04199}, {-1.017, 13.9, 0.1189}},
    {{0.2384, 100.8, 0.04321}, {-1.171, 15.8, 0.1313}},   {{-0.04754, 107.7, 0.04424}, {-1.284, 17.9, 0.1408}},
    {{-0.2156, 114.7, 0.04494}, {-1.327, 20.2, 0.1492}},  {{-0.2135, 121.5, 0.04544}, {-1.27, 22.8, 0.1592}},
    {{-0.08593, 127.6, 0.04594}, {-1.134, 25.6, 0.1716}}, {{0.07739, 132.9, 0.04683}, {-0.9769, 29.0, 0.1847}},
    {{0.2733, 138.0, 0.04861}, {-0.851, 32.9, 0.1956}},   {{0.7187, 144.0, 0.05049}, {-0.7884, 37.2, 0.2018}},
    {{1.289, 151.2, 0.04877}, {-0.8051, 41.6, 0.2024}},   {{1.256, 157.2, 0.04404}, {-0.9093, 45.8, 0.1977}},
    {{0.9642, 160.4, 0.04109}, {-1.102, 49.4, 0.189}},    {{0.895, 161.9, 0.0401}, {-1.365, 52.0, 0.1784}},
    {{0.9387, 162.5, 0.03983}, {-1.641, 53.9, 0.1685}},   {{0.9972, 162.9, 0.03973}, {-1.833, 55.1, 0.1619}},
    {{1.046, 163.1, 0.03969}, {-1.854, 56.2, 0.1603}},    {{1.082, 163.3, 0.03966}, {-1.702, 57.3, 0.163}},
    {{1.108, 163.3, 0.03964}, {-1.513, 58.2, 0.1666}},
}};
constexpr std::array<Growth, 19> male_growth{{
    {{0.9415, 86.5, 0.04032}, {-0.2062, 12.7, 0.1081}},  {{-0.3474, 95.0, 0.04059}, {-0.6032, 14.3, 0.1116}},
    {{0.7929, 102.2, 0.0413}, {-0.9084, 16.2, 0.1196}},  {{1.261, 108.9, 0.04254}, {-0.998, 18.4, 0.1295}},
    {{1.15, 115.4, 0.04364}, {-1.082, 20.7, 0.1388}},    {{0.7697, 121.8, 0.04438}, {-1.23, 23.1, 0.147}},
    {{0.4629, 127.9, 0.04509}, {-1.349, 25.6, 0.1556}},  {{0.4131, 133.5, 0.04616}, {-1.343, 28.6, 0.1662}},
    {{0.5026, 138.6, 0.04755}, {-1.214, 31.9, 0.1784}},  {{0.4918, 143.5, 0.04889}, {-1.027, 35.9, 0.1896}},
    {{0.4188, 149.1, 0.04991}, {-0.8439, 40.5, 0.1964}}, {{0.7868, 156.1, 0.05034}, {-0.7028, 45.6, 0.1968}},
    {{1.636, 163.8, 0.04905}, {-0.6329, 51.0, 0.1911}},  {{2.196, 169.9, 0.04602}, {-0.6621, 56.3, 0.1821}},
    {{2.126, 173.5, 0.04318}, {-0.7949, 60.9, 0.1728}},  {{1.741, 175.3, 0.04146}, {-0.9669, 64.6, 0.1659}},
    {{1.41, 176.2, 0.04066}, {-1.065, 67.2, 0.162}},     {{1.234, 176.6, 0.0404}, {-1.027, 69.1, 0.1602}},
    {{1.167, 176.8, 0.04037}, {-0.9165, 70.6, 0.1615}},
}};

constexpr double first_age = 2, largest_score = 2, correlation = 0.5;

Chart between(const Chart& a, const Chart& b, double share) {
    return {a.l + share * (b.l - a.l), a.m + share * (b.m - a.m), a.s + share * (b.s - a.s)};
}

// Linear between the years.
Growth growth_at(double age, bool is_male) {
    const auto& charts = is_male ? male_growth : female_growth;
    const double years = std::clamp(age - first_age, 0.0, static_cast<double>(charts.size() - 1));
    const std::size_t below = std::min(static_cast<std::size_t>(years), charts.size() - 2);
    const double share = years - static_cast<double>(below);
    const Growth &a = charts[below], &b = charts[below + 1];
    return {between(a.height, b.height, share), between(a.mass, b.mass, share)};
}

double value_at(const Chart& chart, double score) {
    return chart.m * std::pow(1 + chart.l * chart.s * score, 1 / chart.l);
}

double score_of(const Chart& chart, double value) {
    const double score = (std::pow(value / chart.m, chart.l) - 1) / (chart.l * chart.s);
    return std::clamp(score, -largest_score, largest_score);
}

// Returns the score of one size, given the score `other` of the other size.
double correlated_score(double other, double draw) {
    const double own = Spread(-largest_score, largest_score, 0, 1).at(draw);
    return std::clamp(correlation * other + std::sqrt(1 - correlation * correlation) * own, -largest_score,
                      largest_score);
}

PersonSize size_of_child(const Growth& growth, const std::optional<double>& height, const std::optional<double>& mass,
                         const PersonDraws& draws) {
    constexpr double cm = 0.01;
    if (height && mass) return {*height, *mass};
    if (mass) {
        const double score = correlated_score(score_of(growth.mass, *mass), draws.height);
        return {cm * value_at(growth.height, score), *mass};
    }
    const double score =
        height ? score_of(growth.height, *height / cm) : Spread(-largest_score, largest_score, 0, 1).at(draws.height);
    return {height ? *height : cm * value_at(growth.height, score),
            value_at(growth.mass, correlated_score(score, draws.mass))};
}

// Heights, m, and masses, kg, that people of these ages may have, in whole centimetres and tenths of a kilogram.
Interval heights_at(const Interval& age) {
    const double lo = 0.6 * std::min(growth_at(age.hi, false).height.m, growth_at(age.hi, true).height.m);
    const double hi = 1.4 * std::max(growth_at(age.lo, false).height.m, growth_at(age.lo, true).height.m);
    return {age.hi < adult_age ? std::floor(lo) / 100 : 1, age.lo < adult_age ? std::ceil(hi) / 100 : 2.5};
}
Interval masses_at(const Interval& age) {
    const double lo = 0.4 * std::min(growth_at(age.hi, false).mass.m, growth_at(age.hi, true).mass.m);
    const double hi = 4 * std::max(growth_at(age.lo, false).mass.m, growth_at(age.lo, true).mass.m);
    return {age.hi < adult_age ? std::floor(10 * lo) / 10 : 0, age.lo < adult_age ? std::ceil(10 * hi) / 10 : 1000};
}

std::string in_short(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", value);
    return text;
}

std::string words_of(const Interval& age) {
    return age.lo == age.hi ? "at an age of " + in_short(age.lo) + " years"
                            : "at ages of " + in_short(age.lo) + " to " + in_short(age.hi) + " years";
}

// The first value of `given` outside of `allowed`, as a sentence.
std::optional<std::string> outside(const Spread& given, const Interval& allowed, const std::string& unit,
                                   const Interval& age) {
    if (allowed.contains(given.lo) && allowed.contains(given.hi)) return std::nullopt;
    const double value = allowed.contains(given.hi) ? given.lo : given.hi;
    return in_short(value) + unit + " is no body of a person " + words_of(age) + "; allowed: " + in_short(allowed.lo) +
           " to " + in_short(allowed.hi) + unit + ", or another age.";
}

// Mass over the square of the height, kg/m2: 8 and 100 are beyond what people lived with.
std::optional<std::string> fault_of_index(double mass, double height) {
    constexpr double least = 8, most = 100;
    const double square = height * height, index = mass / square;
    if (index >= least && index <= most) return std::nullopt;
    const auto tenths = [](double value) { return in_short(std::round(10 * value) / 10); };
    return in_short(mass) + " kg with a height of " + in_short(height) + " m is no body of a person, " + tenths(index) +
           " kg/m2; allowed: " + tenths(least * square) + " to " + tenths(most * square) + " kg for this height.";
}

}  // namespace

PersonSize size_of_person(const AgentGroup& group, const PersonRow& row, double age, bool is_male,
                          const PersonDraws& draws) {
    const bool is_child = age < adult_age, of_group = are_children(group.body.age) == is_child;
    std::optional<double> height = row.height, mass = row.mass;
    if (!height && of_group && group.body.height) height = group.body.height->at(draws.height);
    if (!mass && of_group && group.mass) mass = group.mass->at(draws.mass);
    if (is_child) return size_of_child(growth_at(age, is_male), height, mass, draws);
    const PersonSize adult;
    return {height.value_or(adult.height), mass.value_or(adult.mass)};
}

std::optional<SizeFault> fault_of_size(const std::optional<Interval>& age, const std::optional<Spread>& height,
                                       const std::optional<Spread>& mass) {
    if (age && height) {
        if (const auto sentence = outside(*height, heights_at(*age), " m", *age)) return SizeFault{false, *sentence};
    }
    if (age && mass) {
        if (const auto sentence = outside(*mass, masses_at(*age), " kg", *age)) return SizeFault{true, *sentence};
    }
    const bool are_adults = age && age->lo >= adult_age;
    if (!are_adults && !(height && mass)) return std::nullopt;  // one follows the other
    const PersonSize adult;
    const Spread of_height = height.value_or(adult.height), of_mass = mass.value_or(adult.mass);
    for (const auto& [kg, m] : {std::pair(of_mass.hi, of_height.lo), std::pair(of_mass.lo, of_height.hi)}) {
        if (const auto sentence = fault_of_index(kg, m)) return SizeFault{true, *sentence};
    }
    return std::nullopt;
}

}  // namespace wade
