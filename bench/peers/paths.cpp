// Searches paths on a map with OMPL and prints what it finds as JSON.
//
// paths MAP.pgm RRT|RRT-Connect|RRT* RUNS RESOLUTION; the map's first row is the southern one and 0 is occupied, the
// resolution is the distance in cells at which edges are checked.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include <ompl/base/PlannerTerminationCondition.h>
#include <ompl/base/ProblemDefinition.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/PathSimplifier.h>
#include <ompl/geometric/planners/rrt/RRT.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/geometric/planners/rrt/RRTstar.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

namespace ob = ompl::base;
namespace og = ompl::geometric;

constexpr int SIZE = 512;

// Wall time or the time that the process had the processor, whichever is less: other work on the machine disturbs that
// little.
class Stopwatch {
public:
    double millis() const { return std::min(now(CLOCK_MONOTONIC) - wall, now(CLOCK_THREAD_CPUTIME_ID) - thread); }

private:
    static double now(clockid_t clock) {
        timespec time{};
        clock_gettime(clock, &time);
        return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
    }

    double thread = now(CLOCK_THREAD_CPUTIME_ID);
    double wall = now(CLOCK_MONOTONIC);
};

static void print_path(const char *name, og::PathGeometric *path) {
    std::printf("\"%s\":[", name);
    if (path != nullptr) {
        for (std::size_t at = 0; at < path->getStateCount(); ++at) {
            const auto *point = path->getState(at)->as<ob::RealVectorStateSpace::StateType>();
            std::printf("%s[%.17g,%.17g]", at == 0 ? "" : ",", point->values[0], point->values[1]);
        }
    }
    std::printf("]");
}

int main(int count, char **arguments) {
    if (count != 5) {
        std::fprintf(stderr, "paths MAP.pgm PLANNER RUNS RESOLUTION\n");
        return 2;
    }
    std::ifstream file(arguments[1], std::ios::binary);
    std::vector<char> bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    if (bytes.size() < static_cast<std::size_t>(SIZE) * SIZE) {
        std::fprintf(stderr, "%s is no map\n", arguments[1]);
        return 2;
    }
    const std::vector<char> cells(bytes.end() - SIZE * SIZE, bytes.end());
    const std::string planner_name = arguments[2];
    const int runs = std::atoi(arguments[3]);
    const double resolution = std::atof(arguments[4]);

    ompl::msg::setLogLevel(ompl::msg::LOG_NONE);
    ompl::RNG::setSeed(1);
    auto space = std::make_shared<ob::RealVectorStateSpace>(2);
    space->setBounds(0.0, SIZE);
    auto information = std::make_shared<ob::SpaceInformation>(space);
    information->setStateValidityChecker([&cells](const ob::State *state) {
        const auto *point = state->as<ob::RealVectorStateSpace::StateType>();
        const int column = static_cast<int>(point->values[0]);
        const int row = static_cast<int>(point->values[1]);
        return column >= 0 && row >= 0 && column < SIZE && row < SIZE && cells[row * SIZE + column] != 0;
    });
    information->setStateValidityCheckingResolution(resolution / space->getMaximumExtent());
    information->setup();

    std::printf("[");
    for (int run = 0; run < runs; ++run) {
        ob::ScopedState<ob::RealVectorStateSpace> start(space);
        ob::ScopedState<ob::RealVectorStateSpace> goal(space);
        start[0] = start[1] = 8.0;
        goal[0] = goal[1] = 503.0;
        auto problem = std::make_shared<ob::ProblemDefinition>(information);
        problem->setStartAndGoalStates(start, goal);
        ob::PlannerPtr planner;
        auto stop = ob::exactSolnPlannerTerminationCondition(problem);
        if (planner_name == "RRT-Connect") {
            auto connect = std::make_shared<og::RRTConnect>(information);
            connect->setRange(20.0);
            planner = connect;
        } else if (planner_name == "RRT") {
            auto rrt = std::make_shared<og::RRT>(information);
            rrt->setRange(20.0);
            rrt->setGoalBias(0.05);
            planner = rrt;
        } else {
            auto star = std::make_shared<og::RRTstar>(information);
            star->setRange(20.0);
            star->setGoalBias(0.05);
            planner = star;
            // RRT* hands its solution over only at its end, so it is asked for the cost of its best path.
            auto *tree = star.get();
            stop = ob::PlannerTerminationCondition([tree] { return tree->bestCost().value() < 1e9; });
        }
        planner->setProblemDefinition(problem);
        planner->setup();
        const auto first = ob::plannerOrTerminationCondition(stop, ob::timedPlannerTerminationCondition(2.0));
        const Stopwatch searching;
        planner->solve(first);
        const double first_ms = searching.millis();
        og::PathGeometric *path = nullptr;
        if (problem->hasExactSolution()) {
            path = problem->getSolutionPath()->as<og::PathGeometric>();
        }
        std::printf("%s{\"first_ms\":%.6f,", run == 0 ? "" : ",", first_ms);
        print_path("path", path);
        double simplify_ms = 0.0;
        if (path != nullptr) {
            const Stopwatch simplifying;
            og::PathSimplifier(information).simplifyMax(*path);
            simplify_ms = simplifying.millis();
        }
        std::printf(",\"simplify_ms\":%.6f,", simplify_ms);
        print_path("simplified", path);
        std::printf("}");
    }
    std::printf("]\n");
    return 0;
}
