#include "robot/common/statistics.hpp"

#include <gtest/gtest.h>

#include <boost/math/distributions/normal.hpp>

namespace biopsy {
namespace {

// Reference values of mean, standard deviation and rms: Python's statistics module.
TEST(Statistics, AgreeWithReferenceValues) {
  const std::vector<double> values{3.5, -1.0, 4.25, 1.0, 5.5, 9.0};
  EXPECT_DOUBLE_EQ(mean(values), 3.7083333333333335);
  EXPECT_DOUBLE_EQ(standard_deviation(values), 3.4943406626524935);
  EXPECT_DOUBLE_EQ(rms(values), 4.89153179825434);
  EXPECT_EQ(quantile(values, 0.0), -1.0);
  EXPECT_EQ(quantile(values, 0.5), 3.5);
  EXPECT_EQ(quantile(values, 0.9), 5.5);
  EXPECT_EQ(quantile(values, 1.0), 9.0);
  EXPECT_EQ(median(values), 4.25);  // the upper of 3.5 and 4.25
  EXPECT_EQ(median(std::vector<float>{3, 1, 2}), 2.0f);
}

TEST(Statistics, ConstantsAreThoseOfTheNormalDistribution) {
  const boost::math::normal normal;
  EXPECT_DOUBLE_EQ(kTwoSided95, quantile(normal, 0.975));
  EXPECT_NEAR(kMadToSigma, 1.0 / quantile(normal, 0.75), 1e-5);
}

TEST(Statistics, OfTooFewValuesAreNaN) {
  const std::vector<double> none;
  EXPECT_TRUE(std::isnan(mean(none)) && std::isnan(rms(none)) && std::isnan(median(none)) &&
              std::isnan(quantile(none, 0.5)) && std::isnan(standard_deviation(std::vector<double>{1.0})));
}

}  // namespace
}  // namespace biopsy
