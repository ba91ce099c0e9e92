// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

namespace relume::gbuffer {

/// Small dense matrices in double precision, for camera recovery.
template <std::size_t N> using Matrix = std::array<std::array<double, N>, N>;
template <std::size_t N> using Vector = std::array<double, N>;

using Vector3 = Vector<3>;

inline double dot(const Vector3& a, const Vector3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Vector3 cross(const Vector3& a, const Vector3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline double length(const Vector3& a) { return std::sqrt(dot(a, a)); }
inline Vector3 scaled(const Vector3& a, double s) { return {a[0] * s, a[1] * s, a[2] * s}; }
inline Vector3 minus(const Vector3& a, const Vector3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Vector3 plus(const Vector3& a, const Vector3& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline double determinant(const Matrix<3>& m) { return dot(m[0], cross(m[1], m[2])); }
inline Vector3 times(const Matrix<3>& m, const Vector3& v) { return {dot(m[0], v), dot(m[1], v), dot(m[2], v)}; }
inline Matrix<3> times(const Matrix<3>& a, const Matrix<3>& b) {
    Matrix<3> result{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            for (std::size_t k = 0; k < 3; ++k) result[i][j] += a[i][k] * b[k][j];
        }
    }
    return result;
}
inline Matrix<3> transposed(const Matrix<3>& m) {
    Matrix<3> result{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) result[i][j] = m[j][i];
    }
    return result;
}

/// Eigenvalues (ascending) and eigenvectors (column k of `vectors` belongs to values[k]) of a symmetric matrix, by
/// cyclic Jacobi rotations (Golub, Van Loan 2013, section 8.5).
template <std::size_t N> struct Eigen {
    Vector<N> values{};
    Matrix<N> vectors{};
};

template <std::size_t N> Eigen<N> symmetric_eigen(Matrix<N> a) {
    Matrix<N> v{};
    for (std::size_t i = 0; i < N; ++i) v[i][i] = 1;
    for (int sweep = 0; sweep < 60; ++sweep) {
        double off = 0, diagonal = 0;
        for (std::size_t i = 0; i < N; ++i) {
            diagonal += a[i][i] * a[i][i];
            for (std::size_t j = i + 1; j < N; ++j) off += a[i][j] * a[i][j];
        }
        if (!(off > 1e-40 * diagonal)) break;
        for (std::size_t p = 0; p < N; ++p) {
            for (std::size_t q = p + 1; q < N; ++q) {
                if (a[p][q] == 0) continue;
                const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
                const double t = (theta >= 0 ? 1.0 : -1.0) / (std::abs(theta) + std::sqrt(theta * theta + 1));
                const double c = 1 / std::sqrt(t * t + 1), s = t * c;
                for (std::size_t k = 0; k < N; ++k) {
                    const double akp = a[k][p], akq = a[k][q];
                    a[k][p] = c * akp - s * akq;
                    a[k][q] = s * akp + c * akq;
                }
                for (std::size_t k = 0; k < N; ++k) {
                    const double apk = a[p][k], aqk = a[q][k];
                    a[p][k] = c * apk - s * aqk;
                    a[q][k] = s * apk + c * aqk;
                    const double vkp = v[k][p], vkq = v[k][q];
                    v[k][p] = c * vkp - s * vkq;
                    v[k][q] = s * vkp + c * vkq;
                }
            }
        }
    }
    Eigen<N> result;
    for (std::size_t i = 0; i < N; ++i) result.values[i] = a[i][i];
    result.vectors = v;
    for (std::size_t i = 0; i < N; ++i) {
        std::size_t smallest = i;
        for (std::size_t j = i + 1; j < N; ++j) {
            if (result.values[j] < result.values[smallest]) smallest = j;
        }
        std::swap(result.values[i], result.values[smallest]);
        for (std::size_t k = 0; k < N; ++k) std::swap(result.vectors[k][i], result.vectors[k][smallest]);
    }
    return result;
}

/// Solves a·x = b for a symmetric positive definite matrix by Cholesky's factorisation; false when it is not.
template <std::size_t N> bool solve(Matrix<N> a, const Vector<N>& b, Vector<N>& x) {
    for (std::size_t j = 0; j < N; ++j) {
        for (std::size_t k = 0; k < j; ++k) a[j][j] -= a[j][k] * a[j][k];
        if (!(a[j][j] > 0)) return false;
        a[j][j] = std::sqrt(a[j][j]);
        for (std::size_t i = j + 1; i < N; ++i) {
            for (std::size_t k = 0; k < j; ++k) a[i][j] -= a[i][k] * a[j][k];
            a[i][j] /= a[j][j];
        }
    }
    for (std::size_t i = 0; i < N; ++i) {
        x[i] = b[i];
        for (std::size_t k = 0; k < i; ++k) x[i] -= a[i][k] * x[k];
        x[i] /= a[i][i];
    }
    for (std::size_t i = N; i-- > 0;) {
        for (std::size_t k = i + 1; k < N; ++k) x[i] -= a[k][i] * x[k];
        x[i] /= a[i][i];
    }
    return true;
}

}  // namespace relume::gbuffer
