#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "../../src/io/format/atomic_file.hpp"
#include "../../src/io/measurements/target_names.hpp"
#include "campaign_text.hpp"
#include "posewise/core/random.hpp"
#include "posewise/io/measurements_file.hpp"
#include "posewise/io/result_files.hpp"
#include "support/combined.hpp"
#include "support/slips.hpp"
#include "support/temporary_folder.hpp"

/// Points of an instrument, joined with the plan that they were measured at.
namespace posewise::io {
namespace {

using testing::input_error_of;
using testing::replaced;
using testing::TemporaryFolder;

const CampaignFile& crane_file() {
    static const CampaignFile file = [] {
        const TemporaryFolder folder;
        return read_campaign(folder.write("c.yaml", testing::campaign_text));
    }();
    return file;
}

PlannedPose pose(const std::string& id, double q1, double q2, double lift) {
    PlannedPose one;
    one.id = id;
    one.configuration = Vector3d(q1, q2, lift);
    return one;
}

/// Three poses to calibrate with, of which the second one shows the second target only, and one to
/// verify with.
Plan planned() {
    Plan plan;
    plan.campaign = crane_file().name;
    plan.columns = configuration_columns(crane_file());
    plan.poses = {pose("p1", 0.1, 0.2, 0.3), pose("p2", 0.4, 0.5, 0.1), pose("p3", -0.3, 0.7, 0.2)};
    plan.poses[1].targets = {1};
    plan.verification = {pose("v1", 0.6, -0.2, 0.4)};
    plan.request.pose_count = 3;
    return plan;
}

const std::vector<std::string> names{"P001_T1", "P001_T2", "P002_T2", "P003_T1",
                                     "P003_T2", "V001_T1", "V001_T2"};
Vector3d position(std::size_t k) {
    const auto x = static_cast<double>(k);
    return {1000 + x, 200.5 - 3 * x, -30.25 * x};
}

std::vector<std::string> cells_of(const std::string& line) {
    std::vector<std::string> cells;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    return cells;
}

/// A list of all points, each as `row` writes it.
template <class Row>
std::string list_of(const std::vector<std::size_t>& order, const Row& row) {
    std::string text;
    for (const std::size_t k : order) text += row(names[k], position(k)) + '\n';
    return text;
}
const std::vector<std::size_t> in_order{0, 1, 2, 3, 4, 5, 6};
const std::vector<std::size_t> shuffled{5, 2, 0, 6, 3, 1, 4};

MeasurementsFile read_points(const std::string& text, const std::string& unit = "mm",
                             const Plan& plan = planned()) {
    const TemporaryFolder folder;
    return read_measurements(folder.write("p.txt", text), crane_file(), {&plan, "plan.json", unit});
}

/// As a table has them.
MeasurementsFile all_points() {
    std::string text =
        "config,q1_rad,q2_rad,lift_m,p1_x_mm,p1_y_mm,p1_z_mm,p2_x_mm,p2_y_mm,p2_z_mm\n";
    const auto cells = [](std::size_t k) {
        return fmt::format(",{},{},{}", position(k).x(), position(k).y(), position(k).z());
    };
    text += "p1,0.1,0.2,0.3" + cells(0) + cells(1) + "\np2,0.4,0.5,0.1,,," + cells(2) +
            "\np3,-0.3,0.7,0.2" + cells(3) + cells(4) + "\nv1,0.6,-0.2,0.4" + cells(5) + cells(6) +
            '\n';
    const TemporaryFolder folder;
    return read_measurements(folder.write("m.csv", text), crane_file());
}

void expect_same_points(const Measurements& a, const Measurements& b) {
    EXPECT_EQ(a.ids, b.ids);
    EXPECT_EQ(a.first_sample, b.first_sample);
    EXPECT_EQ(a.configurations, b.configurations);
    ASSERT_TRUE((a.is_seen == b.is_seen).all());
    for (Index sample = 0; sample < a.is_seen.rows(); ++sample) {
        for (const Index target : targets_seen(a.is_seen.row(sample))) {
            EXPECT_EQ(a.observation(sample, target), b.observation(sample, target));
        }
    }
}

TEST(PlannedPoints, EveryFormatInAnyOrderIsWhatATableHas) {
    const Measurements expected = all_points();
    const auto numbers = [](const Vector3d& x, const char* between) {
        return fmt::format("{}{}{}{}{}", x.x(), between, x.y(), between, x.z());
    };
    const std::vector<std::string> lists{
        list_of(shuffled, [&](auto name, auto x) { return name + ' ' + numbers(x, "  "); }),
        list_of(shuffled, [&](auto name, auto x) { return name + '\t' + numbers(x, "\t") + "\r"; }),
        list_of(shuffled, [&](auto name, auto x) { return name + "; " + numbers(x, " ;"); }),
        list_of(shuffled, [&](auto name, auto x) { return name + ',' + numbers(x, ", ") + ","; }),
        "// SA\n//\n" + list_of(shuffled,
                                [&](auto name, auto x) {
                                    return "Cell 7::Main::" + name + ", " + numbers(x, ", ");
                                }),
        list_of(shuffled,
                [&](auto name, auto x) { return "A::B::" + name + ' ' + numbers(x, " "); }),
        list_of(shuffled,
                [&](auto name, auto x) { return "A \"B C\" " + name + ' ' + numbers(x, " "); }),
        list_of(shuffled, [&](auto name, auto x) { return "B," + name + ',' + numbers(x, ","); }),
        list_of(in_order, [&](auto, auto x) { return numbers(x, " "); }),
        list_of(in_order, [&](auto name, auto x) { return "at" + name + ' ' + numbers(x, " "); }),
        "Name,X [mm],Y [mm],Z [mm]\n" +
            list_of(shuffled, [&](auto name, auto x) { return name + ',' + numbers(x, ","); }),
        "# made by hand\nZ_mm;note;point;x_mm;y_mm\n" +
            list_of(shuffled,
                    [&](auto name, auto x) {
                        return fmt::format("{};a, b;{};{};{}", x.z(), name, x.x(), x.y());
                    }),
        "name X [mm] Y [mm] Z [mm]\n" +
            list_of(shuffled, [&](auto name, auto x) { return name + ' ' + numbers(x, " "); }),
        "Name,Nom X,Nom Y,Nom Z,Meas X,Meas Y,Meas Z\n" +
            list_of(shuffled,
                    [&](auto name, auto x) { return name + ",1,2,3," + numbers(x, ","); }),
        "name,x_m,y_m,z_m\n" + list_of(shuffled,
                                       [&](auto name, const Vector3d& x) {
                                           return fmt::format("{},{},{},{}", name, x.x() / 1000,
                                                              x.y() / 1000, x.z() / 1000);
                                       }),
    };
    for (const std::string& text : lists) {
        SCOPED_TRACE(text);
        const bool is_in_m = text.find("x_m,") != std::string::npos;
        const MeasurementsFile read_here = read_points(text, is_in_m ? "" : "mm");
        expect_same_points(read_here, expected);
        EXPECT_TRUE(read_here.is_joined);
    }
    EXPECT_EQ(read_points(lists[0]).joined, "");
    EXPECT_EQ(read_points(lists[8]).joined,
              "no name is one of the plan's, so they are taken in its order: 4 of 4 poses");
    EXPECT_EQ(read_points(lists[11]).unused_columns, std::vector<std::string>{"note"});
}

TEST(PlannedPoints, MayBeInInches) {
    for (const char* const header :
         {"name X [in] Y [in] Z [in]\n", "name,x_inch,y_inch,z_inch\n", "name X Y Z\n"}) {
        const std::string text = header + std::string("P001_T1 10 -2.5 1\n");
        const std::string list =
            text[4] == ',' ? replaced(text, "P001_T1 10 -2.5 1", "P001_T1,10,-2.5,1") : text;
        const bool states = list.find("in") != std::string::npos;
        const MeasurementsFile read_here = read_points(list, states ? "" : "inch");
        EXPECT_TRUE(
            read_here.observation(0, 0).transpose().isApprox(Vector3d(0.254, -0.0635, 0.0254)))
            << list;
    }
}

TEST(PlannedPoints, WithoutThoseThatAreMissing) {
    const std::string text = "P001_T2 1 2 3\nV001_T1 4 5 6\nP002_T1 7 8 9\n";
    const MeasurementsFile some = read_points(text);
    EXPECT_EQ(some.ids, (std::vector<std::string>{"p1", "p2", "v1"}));
    EXPECT_TRUE((some.is_seen == Seen{{false, true}, {true, false}, {true, false}}).all());
    EXPECT_EQ(some.configurations.row(2), planned().verification[0].configuration.transpose());
    EXPECT_EQ(some.observations.row(0).tail(3), Eigen::RowVector3d(0.001, 0.002, 0.003));
    EXPECT_EQ(some.joined,
              "3 of 4 poses, without 'p3', 3 points missing: P001_T1, P002_T2, V001_T2");
}

TEST(PlannedPoints, MayHaveTimesAndTemperatures) {
    const MeasurementsFile noted = read_points(
        "name,x_mm,y_mm,z_mm,time,temperature_C\n"
        "P003_T1,7,8,9,12:30,21\nP001_T1,1,2,3,12:00,20\nP001_T2,1,2,3,12:06,20.5\n",
        "");
    EXPECT_TRUE(noted.unused_columns.empty());
    ASSERT_EQ(noted.conditions.size(), 2U);
    EXPECT_DOUBLE_EQ(noted.conditions[0].values.at("p3"), 27.0 / 60);
    EXPECT_EQ(noted.conditions[0].values.at("p1"), 0);
    EXPECT_EQ(noted.conditions[1].values.at("p1"), 20.25);
    EXPECT_EQ(read_points("name,x_mm,y_mm,z_mm,time\nP003_T1,7,8,9,noon\n", "").unused_columns,
              std::vector<std::string>{"time"});
}

TEST(PlannedPoints, InOrderWithoutThoseToVerify) {
    const MeasurementsFile some = read_points("1 2 3\n4 5 6\n7 8 9\n10 11 12\n13 14 15\n");
    EXPECT_EQ(some.ids, (std::vector<std::string>{"p1", "p2", "p3"}));
    EXPECT_TRUE((some.is_seen == Seen{{true, true}, {false, true}, {true, true}}).all());
    EXPECT_EQ(some.joined,
              "no name is one of the plan's, so they are taken in its order: 3 of 4 poses, without "
              "'v1'");
}

TEST(PlannedPoints, NamesMayBeWrittenInManyWays) {
    for (const std::string name : {"P001_T2", "p1_t2", "P1T2", "p01-t02", "A::B::P0001.T2",
                                   "::P1_T2", "P_1_T_2", "p1_t2*"}) {
        SCOPED_TRACE(name);
        const MeasurementsFile one = read_points(name + " 1 2 3\n");
        EXPECT_EQ(one.ids, std::vector<std::string>{"p1"});
        EXPECT_TRUE((one.is_seen == Seen{{false, true}}).all());
    }
    EXPECT_EQ(detail::target_name("p1", 0), "P001_T1");
    EXPECT_EQ(detail::target_name("17", 2), "P017_T3");
    EXPECT_EQ(detail::target_name("new pose\xC3\xA9 1234", 9), "NEW_POSE___1234_T10");
    EXPECT_EQ(detail::pose_name(""), "P");
    EXPECT_EQ(detail::name_key("p10_1"), "p10_1");
    EXPECT_NE(detail::name_key("p10_1"), detail::name_key("p1_01"));
    EXPECT_NE(detail::name_key("p10_1"), detail::name_key("p101"));
    EXPECT_EQ(detail::name_key("P000_T0"), "p0t0");
    EXPECT_EQ(detail::name_key("A::"), "");
}

TEST(PlannedPoints, APoseAloneWhereThereIsOneTarget) {
    const TemporaryFolder folder;
    const std::string text =
        replaced(testing::campaign_text, "[[100, 0, 0], [0, 200, -10]]", "[[100, 0, 0]]");
    const CampaignFile one =
        read_campaign(folder.write("c.yaml", replaced(text, "[mA, mB]", "[mA]")));
    Plan plan = planned();
    plan.poses[1].targets = {};
    plan.poses[2].id = "17";
    const auto read_one = [&](const std::string& text) {
        return read_measurements(folder.write("p.txt", text), one, {&plan, "plan.json", "mm"});
    };
    const MeasurementsFile some = read_one("P002 1 2 3\nA::17 4 5 6\np001_t1 7 8 9\n");
    EXPECT_EQ(some.ids, (std::vector<std::string>{"p1", "p2", "17"}));
    EXPECT_EQ(some.observations(2, 0), 0.004);
    EXPECT_EQ(read_one("P017 4 5 6\n").ids, std::vector<std::string>{"17"});
    EXPECT_EQ(input_error_of([&] { read_points("P001 1 2 3\nP001_T1 1 2 3\n"); }),
              "p.txt:1:1: 'P001' is no point of the plan; must be one, such as P001_T1, or be left "
              "out");
}

/// Any ids that differ in more than case, leading zeros and separators have names that do.
TEST(PlannedPoints, NamesOfDifferentIdsDiffer) {
    RandomStream stream(3);
    Plan plan = planned();
    const std::string letters = "pPvV019_- .x";
    for (int trial = 0; trial < 1000; ++trial) {
        for (PlannedPose& one : plan.poses) {
            one.id.clear();
            for (int k = 0; k < 4; ++k) {
                one.id += letters[static_cast<std::size_t>(stream.uniform() * 12)];
            }
        }
        std::string text;
        for (const PlannedPose& one : plan.poses) {
            text += detail::target_name(one.id, 1) + ' ' + fmt::format("{} 1 2", 10 * text.size()) +
                    '\n';
        }
        const auto read_all = [&] {
            const MeasurementsFile some = read_points(text, "mm", plan);
            for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(some.ids[i], plan.poses[i].id) << text;
        };
        const std::string message = input_error_of(read_all);
        if (message == "no error") continue;
        EXPECT_TRUE(testing::is_like(message,
                                     "plan.json: its poses [...] have the same name for an "
                                     "instrument, [...]; must differ"))
            << message;
    }
}

TEST(BadPoints, EachIsNamedInOneLine) {
    const std::string good = "A::B::P001_T1 1 2 3\nA::B::P002_T2 4 5 6\nA::B::V001_T1 7 8 9\n";
    const auto error_of = [](const std::string& text) {
        return input_error_of([&] { read_points(text); });
    };
    ASSERT_EQ(error_of(good), "no error");
    testing::expect_messages(
        good,
        {
            {good, "", " is empty; must be a list of points, name x y z"},
            {good, "// nothing\n", " is empty; must be a list of points, name x y z"},
            {good, "name,x_mm,y_mm,z_mm\n",
             " has a header but no rows; must have at least one row"},
            {"P002_T2", "NEST_1",
             "2:1: 'A::B::NEST_1' is no point of the plan; must be one, such as P001_T1, or be "
             "left "
             "out"},
            {"P002_T2", "p1_t1",
             "2:1: 'A::B::p1_t1' is point P001_T1 once more, which line 1 has; keep one (repeats "
             "need a table with the columns config and sample)"},
            {"4 5 6", "4 5", "2:18: row has 3 fields; must have 4 as the first row"},
            {"4 5 6", "4 5 6 7", "2:21: row has 5 fields; must have 4 as the first row"},
            {"1 2 3", "1 2 3 0.01",
             "1:1: the first row has 5 fields, and is neither a header with x, y and z nor a "
             "point; "
             "[...]"},
            {"1 2 3", "1,5 2,5 3,5", "1:1: the first row has 4 fields, and is neither [...]"},
            {"4 5 6", "4 nan 6",
             "2:17: 'nan' is not finite; must be a finite number with a decimal point, or the "
             "point "
             "be left out"},
            {"4 5 6", "4 -inf 6", "2:17: '-inf' is not finite; [...]"},
            {"4 5 6", "4 1e999 6", "2:17: '1e999' is beyond the range of numbers; [...]"},
            {"4 5 6", "4 1e10 6",
             "2:17: '1e10' is out of any cell; must be at most 1e+09 mm in magnitude"},
            {"4 5 6", "4 5mm 6", "2:17: '5mm' is not a number; [...]"},
            {good, "a 1 2 3\nb 4 5 6\n",
             "1:1: no name (the first is 'a') is one of the plan's, such as P001_T1, and in order "
             "2 "
             "points cannot be the plan's 7; name them as the plan does, or leave none out"},
            {good, "1 2 3\n",
             "1:1: no name is one of the plan's, such as P001_T1, and in order 1 "
             "point cannot be the plan's 7; [...]"},
            {good, "name,x_in,y_in,z_in\n",
             "1:1: the header's unit is inch, `points_unit` is mm; leave that out"},
            {good, "name,x [ft],y [ft],z [ft]\n",
             "1:1: the header's unit is 'ft'; must be mm, m, um or inch"},
            {good, "name,x_mm,y_m,z_mm\n",
             "1:1: the header states different units for x, y and z; must be one for all"},
            {good, "name,x_m,y_m,z_m\n",
             "1:1: the header's unit is m, `points_unit` is mm; leave that out"},
            {good, "name,x,meas x,y,z\n",
             "1:1: the header has x twice, 'x' and 'meas x'; keep what was measured"},
            {good, "name,id,x,y,z\n", "1:1: the header has two columns of names; keep one"},
            {good, "name,x,y,z\n,1,2,3\n", "2:1: the point has no name"},
            {good, "Config,x_mm\n", "1:1: column 'Config' is unknown; did you mean 'config'?"},
            {"P002",
             "P0\xFF"
             "2",
             "2:9: is not UTF-8 text here; must be UTF-8 (or plain ASCII)"},
            {good, std::string("\0\1\2", 3),
             "1:1: the first row has 1 field, and is neither [...]"},
        },
        error_of, "p.txt:");
    const std::string long_line(1 << 20, 'a');
    EXPECT_LT(error_of(long_line).size(), 1000U);
    EXPECT_LT(error_of(good + long_line).size(), 1000U);
}

TEST(BadPoints, WithoutAUnitTheOneThatFitsIsNamed) {
    const Plan plan = planned();
    for (const auto& [unit, factor] :
         {std::pair("mm", 1e3), std::pair("m", 1.0), std::pair("inch", 1 / 0.0254)}) {
        std::string text;
        for (const PlannedPose& one : plan.poses) {
            const Isometry3d flange =
                world_from_flange(crane_file(), crane_file().nominal, one.configuration);
            const Vector3d x = factor * (flange * crane_file().sensor->target_position(
                                                      0, crane_file().nominal.sensor));
            text += fmt::format("{}_T1 {} {} {}\n", one.id, x.x(), x.y(), x.z());
        }
        EXPECT_EQ(
            input_error_of([&] { read_points(text, ""); }),
            fmt::format("p.txt: does not state the unit of its points; state `points_unit`, or "
                        "x_mm, y_mm, z_mm in a header; they are as far apart as planned if it "
                        "is {}",
                        unit));
        EXPECT_EQ(read_points(text, unit).ids.size(), planned().poses.size());
        const std::string wrong = factor > 1 ? "m" : "mm";
        EXPECT_EQ(input_error_of([&] { read_points(text, wrong); }),
                  fmt::format("p.txt: its points are in {} as is stated, but as far apart as "
                              "planned if they are in {}; `points_unit` or the header must state "
                              "the right unit",
                              wrong, unit));
    }
    EXPECT_EQ(input_error_of([&] { read_points("P001_T1 1 2 3\n", "ft"); }),
              "p.txt: `points_unit` is 'ft'; must be mm, m, um or inch");
    EXPECT_EQ(input_error_of([&] { read_points("P001_T1 1 2 3\nP002_T1 2 3 4\n", ""); }),
              "p.txt: does not state the unit of its points; state `points_unit`, or x_mm, y_mm, "
              "z_mm in a header");
}

TEST(BadPoints, ThoseOfAnotherRobotOrWithoutAPlan) {
    const TemporaryFolder folder;
    const std::string path = folder.write("p.txt", "P001_T1 1 2 3\n");
    EXPECT_EQ(
        input_error_of([&] { read_measurements(path, crane_file()); }),
        "p.txt: is a list of points without joint values; must come with the plan whose poses "
        "were measured (`plan` of calibrate, indices, inspect, select and study, `augment_plan` of "
        "plan), or be a table with the column config");
    Plan other = planned();
    other.campaign = "another";
    EXPECT_EQ(input_error_of([&] { read_points("P001_T1 1 2 3\n", "mm", other); }),
              "plan.json: campaign: is 'another'; must be a plan of 'crane'");
    other = planned();
    other.poses[1].id = "P01";
    EXPECT_EQ(input_error_of([&] { read_points("P001_T1 1 2 3\n", "mm", other); }),
              "plan.json: its poses 'p1' and 'P01' have the same name for an instrument, P001_T1; "
              "must differ");
}

TEST(PlanTable, IsAPlanOfItsConfigurations) {
    const TemporaryFolder folder;
    const std::string text =
        "config,q1_deg,q2_rad,lift_mm,visible_targets,purpose,way\n"
        "p1,10,0.2,300,1 2,calibrate,straight\np2.via,0,0,0,,via,straight\n"
        "p2,20,0.5,100,2,calibrate,BLOCKED\nv1,30,0.1,0,1,verify,straight\n";
    const Plan plan = read_plan(folder.write("p.csv", text), crane_file());
    ASSERT_EQ(plan.poses.size(), 2U);
    EXPECT_EQ(plan.poses[1].id, "p2");
    EXPECT_EQ(plan.poses[1].targets, std::vector<Index>{1});
    ASSERT_EQ(plan.verification.size(), 1U);
    EXPECT_EQ(plan.verification[0].configuration[0], to_radians(30));
    EXPECT_EQ(plan.request.pose_count, 2);
    EXPECT_EQ(describe_mismatch(plan, crane_file()), "");
    const std::string twice = folder.write("t.csv", replaced(text, "v1", "p1"));
    EXPECT_EQ(input_error_of([&] { read_plan(twice, crane_file()); }),
              "t.csv: has the configuration 'p1' twice; as a plan it must have each once");
}

TEST(TargetsFile, IsWhereTheNominalRobotHoldsEachTarget) {
    const TemporaryFolder folder;
    const std::string path = folder.path("t.csv");
    const Plan plan = planned();
    write_targets(path, crane_file(), plan);
    const MeasurementsFile read_back = read_measurements(path, crane_file(), {&plan, "plan.json"});
    EXPECT_EQ(read_back.unused_columns, std::vector<std::string>());
    EXPECT_EQ(read_back.ids, (std::vector<std::string>{"p1", "p2", "p3", "v1"}));
    for (Index i = 0; i < 4; ++i) {
        const VectorXd expected = crane_file().sensor->predict(
            world_from_flange(crane_file(), crane_file().nominal,
                              read_back.configurations.row(i).transpose()),
            crane_file().nominal.sensor);
        EXPECT_LT((read_back.observations.row(i).transpose() - expected).cwiseAbs().maxCoeff(),
                  5.1e-8);
    }
}

TEST(TargetsFile, IsAListOfWhatIsVisibleWhereItEndsInTxt) {
    const TemporaryFolder folder;
    const Plan plan = planned();
    const std::string path = folder.path("t.txt");
    write_targets(path, crane_file(), plan);
    const std::string text = detail::read_file(path);
    EXPECT_TRUE(text.starts_with("// name, x, y, z in mm\nP001_T1,")) << text;
    EXPECT_EQ(text.find("P002_T1"), std::string::npos) << text;
    const MeasurementsFile read_back = read_points(text);
    EXPECT_EQ(read_back.joined, "");
    write_targets(folder.path("t.csv"), crane_file(), plan);
    const MeasurementsFile table = read_points(detail::read_file(folder.path("t.csv")));
    EXPECT_EQ(read_back.observations.row(0), table.observations.row(0));
}

/// A plan of one pose that shows the second target of two, and all that follow.
Plan planned_for(const CampaignFile& file) {
    Plan plan;
    PlannedPose one;
    one.id = "p1";
    one.configuration = VectorXd::LinSpaced(file.robot.joint_count(), -0.7, 0.4);
    for (Index k = 1; k < file.sensor->target_count(); ++k) one.targets.push_back(k);
    plan.poses = {one};
    return plan;
}

std::string targets_of(const CampaignFile& file, const std::string& name = "t.csv") {
    const TemporaryFolder folder;
    write_targets(folder.path(name), file, planned_for(file));
    return detail::read_file(folder.path(name));
}

CampaignFile file_of(const std::string& text) {
    const TemporaryFolder folder;
    return read_campaign(folder.write("c.yaml", text));
}

TEST(TargetsFile, IsOfTheTrackerAmongSensors) {
    const std::string alone = targets_of(file_of(testing::tracker_alone));
    EXPECT_NE(alone.find("P001_T2,"), std::string::npos);
    const CampaignFile beside_camera = file_of(testing::tracker_and_camera);
    EXPECT_EQ(targets_of(beside_camera), alone);
    EXPECT_TRUE(targets_of(beside_camera, "t.txt").starts_with("// name, x, y, z in mm\nP001_T2,"));
}

TEST(TargetsFile, TellsSeveralTrackersApart) {
    const std::string frame =
        "    frame: {position_mm: [100, 0, 0], rpy_deg: [0, 0, 90], known: true}\n";
    const CampaignFile two =
        file_of("name: two trackers\n" + testing::combined_arm + testing::tracked_base +
                "sensors:\n" + testing::tracker_part + testing::tracker_part + frame);
    std::istringstream lines(targets_of(two));
    std::string line;
    std::getline(lines, line);
    EXPECT_TRUE(line.ends_with(",visible,sensor")) << line;
    std::vector<Vector3d> points;
    for (const std::string name : {"P001_T1", "P001_T2", "P001_T1", "P001_T2"}) {
        std::getline(lines, line);
        const std::vector<std::string> cells = cells_of(line);
        ASSERT_EQ(cells.size(), 10U) << line;
        EXPECT_EQ(cells[0], name);
        EXPECT_EQ(cells[8], points.empty() ? "no" : "yes");
        EXPECT_EQ(cells[9], points.size() < 2 ? "1" : "2");
        points.emplace_back(std::stod(cells[1]), std::stod(cells[2]), std::stod(cells[3]));
    }
    for (std::size_t k = 0; k < 2; ++k) {
        const Vector3d& first = points[k];
        const Vector3d in_second(first.y(), 100 - first.x(), first.z());
        EXPECT_LT((points[k + 2] - in_second).norm(), 2e-4);
    }
    EXPECT_EQ(input_error_of([&] { targets_of(two, "t.txt"); }),
              "t.txt: is not written: a list that ends in .txt is of one instrument, the campaign "
              "has 2 that measure points; must end in .csv, whose column 'sensor' tells them "
              "apart");
    EXPECT_NE(input_error_of([&] {
                  targets_of(file_of(testing::two_boards));
              }).find("only where a sensor measures points"),
              std::string::npos);
}

TEST(TargetsFile, HasEachNameOnce) {
    const TemporaryFolder folder;
    Plan plan = planned();
    plan.poses[1].id = "P-01";
    EXPECT_EQ(input_error_of([&] { write_targets(folder.path("t.csv"), crane_file(), plan); }),
              "t.csv: is not written: the plan's poses 'p1' and 'P-01' have the same name for an "
              "instrument, P-001_T1; must differ by more than capitals, separators and leading "
              "zeros");
    EXPECT_EQ(folder.file_count(), 0U);
}

TEST(TargetsFile, TellsRangeAnglesAndSight) {
    const TemporaryFolder folder;
    CampaignFile file = crane_file();
    file.cell.sight = Sight{};
    file.cell.sight->normals = {Vector3d::UnitX(), -Vector3d::UnitZ()};
    Plan plan = planned();
    plan.poses.resize(2);
    plan.verification.clear();
    const std::string path = folder.path("t.csv");
    write_targets(path, file, plan);
    std::istringstream lines(detail::read_file(path));
    std::string line;
    std::getline(lines, line);
    EXPECT_EQ(line, "name,x_mm,y_mm,z_mm,range_mm,azimuth_deg,elevation_deg,incidence_deg,visible");
    for (const std::string name : {"P001_T1", "P001_T2", "P002_T1", "P002_T2"}) {
        std::getline(lines, line);
        const std::vector<std::string> cells = cells_of(line);
        ASSERT_EQ(cells.size(), 9U) << line;
        EXPECT_EQ(cells[0], name);
        EXPECT_EQ(cells[8], name == "P002_T1" ? "no" : "yes");
        std::vector<double> numbers;
        for (std::size_t k = 1; k < 8; ++k) numbers.push_back(std::stod(cells[k]));
        const double azimuth = to_radians(numbers[4]);
        const double elevation = to_radians(numbers[5]);
        const Vector3d back =
            numbers[3] * Vector3d(std::cos(elevation) * std::cos(azimuth),
                                  std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
        const Vector3d point(numbers[0], numbers[1], numbers[2]);
        EXPECT_LT((back - point).norm(), 0.01);
        const VectorXd& q = plan.poses[name.starts_with("P001") ? 0 : 1].configuration;
        const Vector3d normal = world_from_flange(file, file.nominal, q).linear() *
                                file.cell.sight->normals[name.ends_with("1") ? 0 : 1];
        EXPECT_NEAR(std::cos(to_radians(numbers[6])), -normal.dot(point.normalized()), 1e-5);
    }
}

}  // namespace
}  // namespace posewise::io
