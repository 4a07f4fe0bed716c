// The yardstick: case 1 as one would write it by hand in scalar C++, doing the same work as the compiled loop
// (finite checks of every state, envelope, refinement of the minimum between steps). Built with
// g++ -O3 -march=native -ffast-math -shared -fPIC.
#include <cmath>
#include <limits>

namespace {

struct Parameters {
    double m, J;
    double k_p, k_theta, K_p1, K_i1, K_d1, K_p2, K_i2, K_d2, N;
    double k_att, k_rep, d_0;
    double x, y, theta, v, omega;
    double goal_x, goal_y;
    double threshold;
    double obstacle_x, obstacle_y, radius;
};

constexpr int states = 9;

inline double right_hand_side(const Parameters& p, const double* x, double* dx) {
    const double ox = x[0] - p.obstacle_x, oy = x[1] - p.obstacle_y;
    const double square = ox * ox + oy * oy;
    const double centre = std::sqrt(square);
    double d = centre - p.radius;
    if (d < 1e-3) d = 1e-3;
    double fx = p.k_att * (p.goal_x - x[0]), fy = p.k_att * (p.goal_y - x[1]);
    if (d <= p.d_0) {
        const double strength = p.k_rep * (p.d_0 - d) / (p.d_0 * d * d * d * centre);
        fx += strength * ox;
        fy += strength * oy;
    }
    const double s = std::sin(x[2]), c = std::cos(x[2]);
    const double along = fx * c + fy * s;
    const double e_v = p.k_p * along - x[3];
    const double e_w = p.k_theta * std::atan2(fy * c - fx * s, along) - x[4];
    const double d_v = p.N * (e_v - x[7]), d_w = p.N * (e_w - x[8]);
    dx[0] = x[3] * c;
    dx[1] = x[3] * s;
    dx[2] = x[4];
    dx[3] = (p.K_p1 * e_v + p.K_i1 * x[5] + p.K_d1 * d_v) / p.m;
    dx[4] = (p.K_p2 * e_w + p.K_i2 * x[6] + p.K_d2 * d_w) / p.J;
    dx[5] = e_v;
    dx[6] = e_w;
    dx[7] = d_v;
    dx[8] = d_w;
    return square;
}

double simulate(const Parameters& p, double dt, int steps) {
    double x[states] = {p.x, p.y, p.theta, p.v, p.omega, 0, 0, 0, 0};
    double a[states], b[states], c[states], d[states], mid_x[states];
    right_hand_side(p, x, a);
    x[7] = a[5];
    x[8] = a[6];
    const double far = std::numeric_limits<double>::max();
    double left = far, mid = far, low = far;
    for (int i = 0; i <= steps; ++i) {
        const double right = right_hand_side(p, x, a);
        double magnitude = right;
        for (int k = 0; k < states; ++k) magnitude += std::fabs(x[k]);
        if (!(magnitude < 1e12) || std::fabs(x[3]) > 1e3 || std::fabs(x[4]) > 1e3) return -1;
        double lowest = right;
        const double bend = left - 2 * mid + right, slope = left - right;
        if (i >= 2 && mid <= left && mid <= right && bend > 0) lowest = mid - 0.125 * slope * slope / bend;
        if (lowest < low) low = lowest;
        left = mid;
        mid = right;
        for (int k = 0; k < states; ++k) mid_x[k] = x[k] + 0.5 * dt * a[k];
        right_hand_side(p, mid_x, b);
        for (int k = 0; k < states; ++k) mid_x[k] = x[k] + 0.5 * dt * b[k];
        right_hand_side(p, mid_x, c);
        for (int k = 0; k < states; ++k) mid_x[k] = x[k] + dt * c[k];
        right_hand_side(p, mid_x, d);
        for (int k = 0; k < states; ++k) x[k] += dt / 6 * (a[k] + 2 * b[k] + 2 * c[k] + d[k]);
    }
    return std::sqrt(low);
}

}  // namespace

extern "C" void simulate_all(const double* parameters, int n, double dt, int steps, double* costs) {
    constexpr int size = sizeof(Parameters) / sizeof(double);
    for (int i = 0; i < n; ++i) {
        costs[i] = simulate(*reinterpret_cast<const Parameters*>(parameters + i * size), dt, steps);
    }
}
