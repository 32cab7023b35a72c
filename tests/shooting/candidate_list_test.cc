// The list of candidates of a search with limits: what is one, where hits go, and who waits.
#include "carnot/shooting/search/candidate_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace carnot::internal::candidate_list_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

// A path of one coordinate from 0 to 1 whose inner nodes are moved by `aside`.
Candidate candidate(double action, double aside, int rung = 0, int intervals = 4) {
  Candidate made;
  Path& path = made.limited.path;
  path.intervals = intervals;
  path.dof = 1;
  path.rung = rung;
  for (int i = 0; i <= intervals; ++i) {
    const bool inside = i > 0 && i < intervals;
    path.q.push_back(static_cast<double>(i) / intervals + (inside ? aside : 0));
  }
  made.action = action;
  return made;
}

std::vector<double> actions_of(const std::vector<Candidate*>& candidates) {
  std::vector<double> actions;
  for (const Candidate* one : candidates) actions.push_back(one->action);
  return actions;
}

TEST(CandidateList, CountsWhatIsAlike) {
  CandidateList list;
  EXPECT_EQ(list.hits_of_least(), 0);
  EXPECT_EQ(list.note(candidate(5, 0)), 0U);
  EXPECT_EQ(list.note(candidate(5.01, 0.01)), 0U);
  EXPECT_EQ(list.note(candidate(4.99, 0.01)), 0U);
  EXPECT_EQ(list.hits_of_least(), 3);
  EXPECT_EQ(list[0].action, 4.99) << "of those that are alike the least";
}

TEST(CandidateList, PartsWhatIsElsewhereOrCostsMoreOrIsOfAnotherProblem) {
  CandidateList list;
  list.note(candidate(5, 0));
  EXPECT_EQ(list.note(candidate(5, 0.1)), 1U);
  EXPECT_EQ(list.note(candidate(5.2, 0)), 2U);
  EXPECT_EQ(list.note(candidate(5, 0, 1)), 3U);
  EXPECT_THAT(actions_of(list.open()), ElementsAre(5, 5, 5.2));
}

TEST(CandidateList, KeepsTheFinerGrid) {
  CandidateList list;
  list.note(candidate(5, 0, 0, 8));
  list.note(candidate(4.99, 0, 0, 4));
  EXPECT_EQ(list[0].limited.path.intervals, 8);
  EXPECT_EQ(list[0].action, 5);
  list.note(candidate(5.01, 0, 0, 16));
  EXPECT_EQ(list[0].limited.path.intervals, 16);
  EXPECT_EQ(list[0].action, 5.01);
  EXPECT_EQ(list.hits_of_least(), 3);
}

TEST(CandidateList, HitsGoDownTheLadder) {
  CandidateList list;
  const std::size_t top = list.note(candidate(7, 0, 2));
  list.note(candidate(7, 0, 2));
  EXPECT_EQ(list.hits_of_least(), 0);
  Candidate lower = list[top];
  lower.limited.path.rung = 1;
  lower.action = 6;
  const std::size_t middle = list.note(lower);
  list.went_down(top, middle);
  lower.limited.path.rung = 0;
  lower.action = 5;
  const std::size_t foot = list.note(lower);
  list.went_down(middle, foot);
  EXPECT_EQ(list.hits_of_least(), 2);
  EXPECT_EQ(list.note(candidate(7, 0, 2)), top);
  EXPECT_EQ(list.hits_of_least(), 3);
  EXPECT_EQ(list.note(candidate(6, 0, 1)), middle);
  EXPECT_EQ(list[foot].hits, 4);
}

TEST(CandidateList, MuchMoreActionWaitsInVain) {
  CandidateList list;
  list.note(candidate(5, 0, 1));
  list.note(candidate(5.9, 0.1, 1));
  list.note(candidate(6.1, 0.2, 1));
  list.note(candidate(4, 0.2, 2));
  EXPECT_THAT(list.waiting_on(1, false), ElementsAre(0, 1));
  EXPECT_THAT(list.waiting_on(1, true), ElementsAre(0, 1, 2));
  EXPECT_THAT(list.waiting_on(2, false), ElementsAre(3));
  list.went_down(0, std::nullopt);
  EXPECT_THAT(list.waiting_on(1, false), ElementsAre(1));
  EXPECT_THAT(list.open(), IsEmpty());
}

TEST(CandidateList, WhatWasTriedIsNotOpen) {
  CandidateList list;
  list.note(candidate(6, 0.2));
  list.note(candidate(5, 0));
  const std::vector<Candidate*> open = list.open();
  ASSERT_THAT(actions_of(open), ElementsAre(5, 6));
  open.front()->tried = true;
  EXPECT_THAT(actions_of(list.open()), ElementsAre(6));
  EXPECT_EQ(list.note(candidate(5, 0)), 2U) << "it may be finished again";
}

}  // namespace
}  // namespace carnot::internal::candidate_list_test
