#pragma once

namespace posewise::detail {

/// The elementary functions that plans depend on, to one unit in the last place, with the same
/// digits on any CPU: those of the C library differ between CPUs with fused multiplication and
/// addition and those without. Not finite or no number where theirs are.

struct SineCosine {
    double sine, cosine;
};
SineCosine sine_and_cosine(double x);

double logarithm(double x);
double exponential(double x);

/// x^y by the logarithm, x at least 0: relative error some 1e-16 |y log x|.
double power(double x, double y);

/// The angle of the point (x, y), as std::atan2.
double arc_tangent(double y, double x);

}  // namespace posewise::detail
