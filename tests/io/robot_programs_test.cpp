#include "posewise/io/robot_programs.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <functional>
#include <numbers>
#include <set>
#include <tuple>

#include "io/format/atomic_file.hpp"
#include "program_examples.hpp"
#include "support/places.hpp"
#include "support/sweep.hpp"
#include "support/temporary_folder.hpp"

// Programs for each controller: what stands in them, and what comes back.

namespace posewise::io {
namespace {

using namespace testing;

TEST(RobotPrograms, AreWhatStandsInTheGoldenFiles) {
    // Reviewed line by line; POSEWISE_WRITE_GOLDEN writes them anew.
    const bool is_written = std::getenv("POSEWISE_WRITE_GOLDEN") != nullptr;
    const std::string golden = source_folder() + "/tests/golden/programs/";
    const TemporaryFolder folder;
    for (const ProgramFormat format : all_formats) {
        const CampaignFile campaign = cell_with(controller_of(format));
        RobotProgram program = cell_program(campaign.controller);
        if (has_handshake(format)) program.handshake = Handshake::Pause;
        const std::string path = (is_written ? golden : folder.path("")) + file_of(format);
        write_robot_program(path, format, program, "", campaign, {});
        for (const std::string& file : program_files(path, format, program)) {
            const std::string name = file.substr(path.size() - file_of(format).size());
            EXPECT_EQ(detail::read_file(file), detail::read_file(golden + name)) << name;
        }
    }
}

TEST(RobotPrograms, ComeBackToHalfOfTheLastDigit) {
    const TemporaryFolder folder;
    const CampaignFile campaign = cell_with(reversed_joints);
    for (const ProgramFormat format : all_formats) {
        const VectorXd steps = joint_steps(format, campaign.controller);
        for (Index i = 0; i < sweep_count(); ++i) {
            RandomStream stream(3, static_cast<std::uint64_t>(i));
            RobotProgram program = cell_program(campaign.controller);
            program.stops.clear();
            for (int k = 1; k <= 10; ++k) {
                const bool is_via = stream.uniform(0, 1) < 0.2;
                program.stops.push_back({is_via ? "via" : fmt::format("p{}", k),
                                         random_vector(stream, 6, 4), !is_via, 1});
            }
            if (has_handshake(format) && i % 2 == 0) program.handshake = Handshake::Pause;
            if (format != ProgramFormat::Staubli && has_handshake(format) && i % 3 == 0) {
                program.handshake = Handshake::Io;
            }
            const std::string path = folder.path(file_of(format));
            write_robot_program(path, format, program, "", campaign, {});
            const auto stops = read_robot_program(path, format, campaign.controller);
            ASSERT_EQ(stops.size(), program.stops.size());
            for (std::size_t k = 0; k < stops.size(); ++k) {
                EXPECT_EQ(stops[k].label, program.stops[k].label);
                EXPECT_EQ(stops[k].is_measured, program.stops[k].is_measured);
                const VectorXd difference = stops[k].joints - program.stops[k].joints;
                EXPECT_LE(difference.cwiseQuotient(steps).cwiseAbs().maxCoeff(), 0.5 + 1e-6)
                    << program_format_name(format);
            }
        }
    }
}

TEST(RobotPrograms, MoveTheFlangeWhereThePlanHasIt) {
    // Couplings, reversed axes and other zeros of several families: what is read back is the
    // model's, to the rounding.
    const TemporaryFolder folder;
    const std::pair<ProgramFormat, std::string> families[] = {
        {ProgramFormat::Fanuc, "{maker: fanuc, j23_factor: -1}"},
        {ProgramFormat::Fanuc, "{maker: fanuc, j23_factor: 0}"},
        {ProgramFormat::Fanuc, "{maker: fanuc, j23_factor: 1}"},
        {ProgramFormat::Kuka, "{joints: [-q1, q2 - 90 deg, 90 deg - q3, -q4, q5, -q6]}"},
        {ProgramFormat::Abb, "{joints: {J3: q2 - q3}}"},
        {ProgramFormat::Ur, "{joints: {J2: q2 - 90 deg, J3: -q3, J4: q4 + q3}}"},
        {ProgramFormat::Yaskawa, reversed_joints},
        {ProgramFormat::Staubli, "{joints: {J5: -q5, J6: q6 - 0.5*q5}}"},
        {ProgramFormat::Ros2, "{joints: {J3: -q3}}"},
    };
    for (const auto& [format, controller] : families) {
        const CampaignFile campaign = cell_with(controller);
        const RobotProgram program = cell_program(campaign.controller);
        const std::string path = folder.path(file_of(format));
        write_robot_program(path, format, program, "", campaign, {});
        const VectorXd steps = joint_steps(format, campaign.controller);
        const ProgramContent content =
            program_content(path, read_robot_program(path, format, campaign.controller), campaign,
                            steps, std::nullopt);
        ASSERT_EQ(content.ids, (std::vector<std::string>{"p1", "p2.via", "p2", "v1"}));
        VectorXd p1(6);
        p1 << 78.7863738, 16.9178212, -61.6481882, 101.9217523, -63.5325953, 28.3155305;
        const auto flange = [&](const VectorXd& q) {
            return campaign.robot.base_from_flange(
                q, VectorXd::Zero(campaign.robot.parameter_count()));
        };
        const Isometry3d planned = flange(p1 * to_radians(1));
        const Isometry3d back = flange(content.joints.row(0).transpose());
        constexpr double reach = 3;  // m
        EXPECT_LT((planned.translation() - back.translation()).norm(), 2 * reach * steps.sum())
            << controller;
    }
}

/// How one maker's controller counts, typed here: its section of the campaign, the same as
/// formulas in degrees and back, and how its file states the numbers.
struct Family {
    ProgramFormat format;
    std::string section;
    std::function<std::vector<double>(const std::vector<double>&)> to_controller;
    std::function<std::vector<double>(const std::vector<double>&)> to_model;
    std::string file;           ///< beside or in what is written
    std::string begin;          ///< what stands before the first number of a position
    std::string between;        ///< letters before each further number, without their digit
    std::vector<double> units;  ///< in which numbers are, of a degree
    double step;                ///< of the last digit, in these units
};

const std::vector<double> all_degrees(6, 1.0);
const std::vector<double> all_radians(6, 180 / std::numbers::pi);

std::vector<Family> typed_families() {
    using V = std::vector<double>;
    const V pulse{1 / 1341.38, 1 / 1907.67, 1 / 1592.89, 1 / 1022.86, 1 / 980.24, 1 / 454.75};
    return {
        {ProgramFormat::Fanuc, "{joints: [q1, q2, q3 - q2, -q4, q5, -q6]}",
         [](const V& q) { return V{q[0], q[1], q[2] - q[1], -q[3], q[4], -q[5]}; },
         [](const V& c) { return V{c[0], c[1], c[2] + c[1], -c[3], c[4], -c[5]}; }, "CELL.LS",
         "J1=", "J", all_degrees, 1e-3},
        {ProgramFormat::Kuka, "{joints: [-q1, q2 - 90 deg, 90 deg - q3 + q2, -q4, q5, -q6]}",
         [](const V& q) { return V{-q[0], q[1] - 90, 90 - q[2] + q[1], -q[3], q[4], -q[5]}; },
         [](const V& c) { return V{-c[0], c[1] + 90, 180 + c[1] - c[2], -c[3], c[4], -c[5]}; },
         "poses.src", "{A1", "A", all_degrees, 1e-5},
        {ProgramFormat::Abb, "{joints: [q1, q2, q2 - q3, -q4, q5, -q6]}",
         [](const V& q) { return V{q[0], q[1], q[1] - q[2], -q[3], q[4], -q[5]}; },
         [](const V& c) { return V{c[0], c[1], c[1] - c[2], -c[3], c[4], -c[5]}; }, "cell.mod",
         "MoveAbsJ [[", "", all_degrees, 1e-4},
        {ProgramFormat::Ur, "{joints: [-q1, q2 - 90 deg, -q3, q4 + q3, q5, 90 deg - q6]}",
         [](const V& q) { return V{-q[0], q[1] - 90, -q[2], q[3] + q[2], q[4], 90 - q[5]}; },
         [](const V& c) { return V{-c[0], c[1] + 90, -c[2], c[3] + c[2], c[4], 90 - c[5]}; },
         "cell.script", "movej([", "", all_radians, 1e-6},
        {ProgramFormat::Yaskawa,
         "{joints: [q1, q2 - 90 deg, q3 + q2, -q4, -q5, q6 - q5], " + example_pulses + "}",
         [](const V& q) { return V{q[0], q[1] - 90, q[2] + q[1], -q[3], -q[4], q[5] - q[4]}; },
         [](const V& c) { return V{c[0], c[1] + 90, c[2] - c[1] - 90, -c[3], -c[4], c[5] - c[4]}; },
         "CELL.JBI", "C0000?=", "", pulse, 1},
        {ProgramFormat::Staubli, "{joints: [-q1, q2, -q3 - 0.5*q2, q4, -q5, q6 - 0.5*q5]}",
         [](const V& q) {
             return V{-q[0], q[1], -q[2] - 0.5 * q[1], q[3], -q[4], q[5] - 0.5 * q[4]};
         },
         [](const V& c) {
             return V{-c[0], c[1], -c[2] - 0.5 * c[1], c[3], -c[4], c[5] - 0.5 * c[4]};
         },
         "cell/cell.dtx", " j1=\"", "j", all_degrees, 1e-5},
    };
}

/// Where `words` begin in the text, '?' for any letter.
std::size_t find_words(const std::string& text, const std::string& words, std::size_t from) {
    const auto is_alike = [](char a, char b) { return b == '?' || a == b; };
    const auto found = std::search(text.begin() + static_cast<std::ptrdiff_t>(from), text.end(),
                                   words.begin(), words.end(), is_alike);
    return static_cast<std::size_t>(found - text.begin());
}

/// The numbers of all positions in a file, in its order, from its text alone.
std::vector<std::vector<double>> positions_in(const std::string& text, const Family& family) {
    std::vector<std::vector<double>> positions;
    for (std::size_t at = find_words(text, family.begin, 0); at < text.size();
         at = find_words(text, family.begin, at)) {
        at += family.begin.size();
        std::vector<double> numbers;
        for (int joint = 1; joint <= 6; ++joint) {
            if (joint > 1 && !family.between.empty()) {
                at = text.find(family.between + std::to_string(joint), at) + family.between.size() +
                     1;
            }
            at = text.find_first_of("-0123456789", at);
            char* end = nullptr;
            numbers.push_back(std::strtod(text.c_str() + at, &end));
            at = static_cast<std::size_t>(end - text.c_str());
        }
        positions.push_back(numbers);
    }
    return positions;
}

TEST(RobotPrograms, StateSignsAndCouplingsOfSixFamilies) {
    const TemporaryFolder folder;
    RandomStream stream(11, 0);
    std::vector<std::vector<double>> poses;
    for (int k = 0; k < 10; ++k) {
        const VectorXd q = random_vector(stream, 6, 1.5) * (180 / std::numbers::pi);
        poses.emplace_back(q.begin(), q.end());
    }
    const auto vector_of = [](const std::vector<double>& q) {
        return VectorXd(Eigen::Map<const VectorXd>(q.data(), 6) * (std::numbers::pi / 180));
    };
    for (const Family& family : typed_families()) {
        const CampaignFile campaign = cell_with(family.section);
        RobotProgram program = cell_program(campaign.controller);
        program.stops.clear();
        for (std::size_t k = 0; k < poses.size(); ++k) {
            program.stops.push_back(
                stop_at(campaign.controller, fmt::format("p{}", k + 1), poses[k]));
        }
        write_robot_program(folder.path(file_of(family.format)), family.format, program, "",
                            campaign, {});
        const auto stated = positions_in(detail::read_file(folder.path(family.file)), family);
        ASSERT_EQ(stated.size(), poses.size()) << family.file;
        for (std::size_t k = 0; k < poses.size(); ++k) {
            const std::vector<double> expected = family.to_controller(poses[k]);
            std::vector<double> shown;
            double turn = 0;  // by which rounding may turn the flange, rad
            for (std::size_t j = 0; j < 6; ++j) {
                const double half = 0.5 * family.step * family.units[j] + 1e-9;
                shown.push_back(stated[k][j] * family.units[j]);
                EXPECT_NEAR(shown[j], expected[j], half) << family.file << " joint " << j + 1;
                turn += 2 * to_radians(half);  // couplings add joints
            }
            const auto flange = [&](const std::vector<double>& q) {
                return campaign.robot.base_from_flange(
                    vector_of(q), VectorXd::Zero(campaign.robot.parameter_count()));
            };
            const Isometry3d off = flange(poses[k]).inverse() * flange(family.to_model(shown));
            constexpr double reach = 3;  // m
            EXPECT_LT(off.translation().norm(), reach * turn) << family.file << ' ' << k;
            EXPECT_LT(Eigen::AngleAxisd(off.linear()).angle(), turn) << family.file << ' ' << k;
        }
    }
}

TEST(RobotPrograms, StateTheFanucsThirdJointAgainstTheGround) {
    const TemporaryFolder folder;
    for (const int factor : {-1, 0, 1}) {
        const CampaignFile campaign =
            cell_with(fmt::format("{{maker: fanuc, j23_factor: {}}}", factor));
        write_robot_program(folder.path("A.ls"), ProgramFormat::Fanuc,
                            cell_program(campaign.controller), "", campaign, {});
        const std::string text = detail::read_file(folder.path("A.ls"));
        // q2 = -30, q3 = 0 at home.
        EXPECT_NE(text.find(fmt::format("\tJ3= {:>9.3f} deg", 30.0 * factor)), std::string::npos)
            << text;
    }
}

// ---- Names ----

std::string hostile_name(RandomStream& stream) {
    static const std::vector<std::string> parts{
        "p",   "1",     "_",  " ",    ".",  "-", "\"",   "'",   "\n",
        "\t",  ";",     "]]", "<!--", "&",  "ä", "\xff", "END", "home",
        "via", "movej", "/",  "\\",   "{}", "0", "A",    "aa",  "verylongnameofapose",
        "%s",  "$(x)",  "#",  "P1",   "p1"};
    std::string name;
    const auto count = static_cast<int>(stream.uniform(0, 6));
    for (int k = 0; k < count; ++k) {
        name += parts[static_cast<std::size_t>(stream.uniform(0, 1) *
                                               static_cast<double>(parts.size()))];
    }
    return name;
}

std::string lower(std::string text) {
    for (char& letter : text)
        letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    return text;
}

bool is_plain(const std::string& name) {
    return std::ranges::all_of(name, [](char letter) {
        return letter == '_' || (letter >= '0' && letter <= '9') ||
               (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z');
    });
}

TEST(PoseLabels, AreLegalAndDistinctForHostileNames) {
    std::vector<std::string> ids;
    for (Index i = 0; i < 10000; ++i) {
        RandomStream stream(8, static_cast<std::uint64_t>(i));
        ids.push_back(hostile_name(stream));
    }
    const std::vector<std::string> labels = pose_labels(ids);
    std::set<std::string> seen;
    for (const std::string& label : labels) {
        EXPECT_TRUE(!label.empty() && label.size() <= 16 && is_plain(label)) << label;
        EXPECT_TRUE(label != "home" && label != "via");
        EXPECT_TRUE(seen.insert(lower(label)).second) << label;
    }
    EXPECT_EQ(pose_labels({"p1", "v1", "17", "P1", "home"}),
              (std::vector<std::string>{"p1", "v1", "17", "P1_2", "p_home"}));
}

/// As the makers have it, typed here.
std::size_t longest_name_of(ProgramFormat format) {
    switch (format) {
        case ProgramFormat::Staubli:
            return 15;
        case ProgramFormat::Kuka:
            return 20;  // 24 less "_123"
        case ProgramFormat::Abb:
            return 28;  // 32 less "_run"
        default:
            return 32;
    }
}

/// Words that a controller has already, typed here.
std::vector<std::string> taken_names_of(ProgramFormat format) {
    switch (format) {
        case ProgramFormat::Fanuc:
            return {"CON", "aux", "NUL"};
        case ProgramFormat::Kuka:
            return {"CELL", "cell", "SPS",  "P00",   "IR_STOPM", "BAS",   "PTP",  "SPTP",   "LIN",
                    "HALT", "WAIT", "AXIS", "XHOME", "E6POS",    "FRAME", "TRUE", "SPLINE", "end"};
        case ProgramFormat::Abb:
            return {"tool0",     "wobj0", "load0", "fine",  "z10",      "z200",
                    "v1000",     "vmax",  "v5",    "MoveL", "MoveJ",    "movec",
                    "SetDO",     "Stop",  "main",  "slow",  "WaitTime", "jointtarget",
                    "robtarget", "Offs",  "pi",    "num",   "TPWrite"};
        case ProgramFormat::Ur:
            return {"movej",
                    "movel",
                    "movep",
                    "movec",
                    "servoj",
                    "speedj",
                    "speedl",
                    "set_digital_out",
                    "sleep",
                    "popup",
                    "textmsg",
                    "get_digital_in",
                    "sync",
                    "stopj",
                    "set_tcp",
                    "set_payload",
                    "get_forward_kin",
                    "pose_trans",
                    "force",
                    "norm",
                    "socket_open",
                    "thread",
                    "end",
                    "True",
                    "global",
                    "set_standard_digital_out"};
        case ProgramFormat::Staubli:
            return {"start", "stop", "begin", "while", "flange", "world"};
        default:
            return {};
    }
}

TEST(ProgramNames, AreLegalForHostileFiles) {
    for (const ProgramFormat format : all_formats) {
        const std::vector<std::string> taken = taken_names_of(format);
        std::size_t longest = 0;
        for (Index i = 0; i < 10000; ++i) {
            RandomStream stream(9, static_cast<std::uint64_t>(i));
            const std::string name = legal_program_name(format, hostile_name(stream));
            ASSERT_TRUE(!name.empty() && is_plain(name)) << name;
            ASSERT_LE(name.size(), longest_name_of(format)) << name;
            longest = std::max(longest, name.size());
            ASSERT_TRUE(std::isalpha(static_cast<unsigned char>(name[0])) != 0) << name;
            ASSERT_EQ(legal_program_name(format, name), name);
            ASSERT_TRUE(std::ranges::none_of(taken, [&](const std::string& word) {
                return lower(word) == lower(name);
            })) << name;
        }
        EXPECT_EQ(longest, longest_name_of(format)) << program_format_name(format);
    }
    EXPECT_EQ(legal_program_name(ProgramFormat::Fanuc, "my cell"), "MY_CELL");
    EXPECT_EQ(legal_program_name(ProgramFormat::Staubli, "a_name_of_over_15"), "a_name_of_over_");
}

TEST(ProgramNames, AreNoneThatTheControllerHasAlready) {
    for (const ProgramFormat format : all_formats) {
        for (const std::string& word : taken_names_of(format)) {
            const std::string prefix = format == ProgramFormat::Fanuc ? "P_" : "p_";
            const std::string name = legal_program_name(format, word);
            EXPECT_EQ(lower(name), "p_" + lower(word)) << program_format_name(format);
            EXPECT_TRUE(name.starts_with(prefix)) << name;
        }
    }
    EXPECT_EQ(legal_program_name(ProgramFormat::Abb, "tool0"), "p_tool0");
    EXPECT_EQ(legal_program_name(ProgramFormat::Abb, "tool1"), "tool1");
    const TemporaryFolder folder;
    const CampaignFile campaign = cell_with(controller_of(ProgramFormat::Kuka));
    const RobotProgram program = cell_program(campaign.controller);
    const std::string message = input_error_of([&] {
        write_robot_program(folder.path("cell.src"), ProgramFormat::Kuka, program, "", campaign,
                            {});
    });
    EXPECT_NE(message.find("p_cell.src"), std::string::npos) << message;
    // The file of these two is free, the routine in it is called otherwise.
    for (const auto& [file, format, begin] :
         {std::tuple{"movel.script", ProgramFormat::Ur, "def p_movel():\n"},
          std::tuple{"tool0.mod", ProgramFormat::Abb, "MODULE p_tool0\r\n"}}) {
        write_robot_program(folder.path(file), format, program, "", campaign, {});
        EXPECT_TRUE(detail::read_file(folder.path(file)).starts_with(begin)) << file;
    }
    EXPECT_EQ(folder.file_count(), 2U);
}

// ---- What is not written ----

TEST(RobotPrograms, AreSplitWhereAControllerNeedsIt) {
    const TemporaryFolder folder;
    const CampaignFile campaign = cell_with(reversed_joints);
    RobotProgram program = cell_program(campaign.controller);
    const ProgramStop pose = program.stops[1];
    while (program.stops.size() < 1000) program.stops.push_back(pose);
    const std::string path = folder.path("long.src");
    write_robot_program(path, ProgramFormat::Kuka, program, "", campaign, {});
    const auto files = program_files(path, ProgramFormat::Kuka, program);
    EXPECT_EQ(files.size(), 8U);
    for (const std::string& file : files) {
        const std::string text = detail::read_file(file);
        EXPECT_LE(std::ranges::count(text, '\n'), 1400) << file;
    }
    EXPECT_EQ(read_robot_program(path, ProgramFormat::Kuka, campaign.controller).size(), 1000U);
    EXPECT_NE(input_error_of([&] {
                  program_files(folder.path("name_of_twenty_chars.src"), ProgramFormat::Kuka,
                                program);
              }).find("must have a name of at most 18"),
              std::string::npos);
    // 9999 lines at most.
    while (program.stops.size() < 7000) program.stops.push_back(pose);
    for (const auto& [name, format] : {std::pair{"Long.ls", ProgramFormat::Fanuc},
                                       std::pair{"LONG.JBI", ProgramFormat::Yaskawa}}) {
        const std::string whole = folder.path(name);
        write_robot_program(whole, format, program, "", campaign, {});
        const auto parts = program_files(whole, format, program);
        EXPECT_EQ(parts.size(), 4U) << name;
        for (const std::string& file : parts) {
            const std::string text = detail::read_file(file);
            const std::string from = format == ProgramFormat::Fanuc ? "/MN\n" : "//INST\r\n";
            const std::string to = format == ProgramFormat::Fanuc ? "/POS\n" : "END\r\n";
            const auto begin = text.begin() + static_cast<long>(text.find(from) + from.size());
            const auto end = text.begin() + static_cast<long>(text.rfind(to));
            EXPECT_LE(std::count(begin, end, '\n'), 9999 + 3) << file;
        }
        const auto stops = read_robot_program(whole, format, campaign.controller);
        ASSERT_EQ(stops.size(), 7000U) << name;
        EXPECT_TRUE(
            std::ranges::equal(stops, program.stops, {}, &ProgramStop::label, &ProgramStop::label));
        // Of a part that was not copied nothing is passed over.
        std::filesystem::remove(parts.back());
        EXPECT_NE(input_error_of([&] {
                      read_robot_program(whole, format, campaign.controller);
                  }).find("calls a program that cannot be used"),
                  std::string::npos);
    }
}

/// The times of all waits in a program, s.
std::vector<double> waits_in(const std::string& text, const std::string& word) {
    std::vector<double> waits;
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
        waits.push_back(std::strtod(text.c_str() + at + word.size(), nullptr));
    }
    return waits;
}

TEST(RobotPrograms, WaitAtLeastAsLongAsTheyAreTold) {
    // As far as the makers' largest times are known, typed here; 0: none is.
    struct Waiting {
        ProgramFormat format;
        std::string word;
        double longest;
    };
    const Waiting makers[] = {
        {ProgramFormat::Fanuc, "  WAIT ", 327.67}, {ProgramFormat::Yaskawa, "TIMER T=", 655.35},
        {ProgramFormat::Kuka, "WAIT SEC ", 0},     {ProgramFormat::Abb, "WaitTime \\InPos,", 0},
        {ProgramFormat::Ur, "sleep(", 0},          {ProgramFormat::Staubli, "delay(", 0},
        {ProgramFormat::Ros2, "dwell_s: ", 0}};
    const TemporaryFolder folder;
    const CampaignFile campaign = cell_with(reversed_joints);
    for (const auto& [format, word, longest] : makers) {
        for (const double dwell :
             {1e-4, 0.001, 0.07, 2.0, 327.67, 327.68, 655.36, 1e4, 123456.789}) {
            RobotProgram program = cell_program(campaign.controller);
            program.stops = {program.stops[1]};
            program.dwell = dwell;
            const std::string path = folder.path(file_of(format));
            write_robot_program(path, format, program, "", campaign, {});
            const std::string file = format == ProgramFormat::Staubli ? path + "/start.pgx" : path;
            const std::string text = detail::read_file(file);
            double sum = 0;
            for (const double wait : waits_in(text, word)) {
                EXPECT_GT(wait, 0) << text;
                EXPECT_LE(wait, longest > 0 ? longest : 1e9);
                sum += wait;
            }
            const double step = longest > 0 ? 0.01 : 0.001;
            EXPECT_GE(sum, dwell - 1e-6 * step) << program_format_name(format);
            EXPECT_LT(sum, dwell + step) << program_format_name(format);
            EXPECT_EQ(text.find("e+0"), std::string::npos);
            EXPECT_EQ(read_robot_program(path, format, campaign.controller).size(), 1U);
        }
    }
}

TEST(RobotPrograms, AreRefusedWhereSomethingIsMissing) {
    const TemporaryFolder folder;
    const CampaignFile campaign = cell_with("{}");
    const RobotProgram program = cell_program(campaign.controller);
    const auto error = [&](const std::string& name, ProgramFormat format, const RobotProgram& one) {
        const std::string message = input_error_of([&] {
            write_robot_program(folder.path(name), format, one, folder.path("sent.csv"), campaign,
                                {});
        });
        EXPECT_EQ(folder.file_count(), 0U) << message;
        return message;
    };
    EXPECT_NE(error("A.jbi", ProgramFormat::Yaskawa, program).find("controller.pulses_per_deg"),
              std::string::npos);
    EXPECT_NE(error("my cell.ls", ProgramFormat::Fanuc, program).find("MY_CELL.ls"),
              std::string::npos);
    EXPECT_NE(error("cell.txt", ProgramFormat::Fanuc, program).find("must end in .ls"),
              std::string::npos);
    EXPECT_NE(error("cell.d", ProgramFormat::Staubli, program).find("is a folder"),
              std::string::npos);
    RobotProgram other = program;
    other.handshake = Handshake::Io;
    EXPECT_NE(error("cell", ProgramFormat::Staubli, other).find("must be none or pause"),
              std::string::npos);
    EXPECT_NE(error("a.yaml", ProgramFormat::Ros2, other).find("must be none"), std::string::npos);
    other = program;
    other.stops[2].joints[1] = std::numeric_limits<double>::quiet_NaN();
    for (const ProgramFormat format : all_formats) {
        if (format == ProgramFormat::Yaskawa) continue;
        EXPECT_NE(error(file_of(format), format, other).find("not finite"), std::string::npos);
    }
    EXPECT_THROW(parse_program_format("kawasaki"), InputError);
}

TEST(RobotPrograms, NameThePartsOfALongerOneThatAreLeft) {
    const TemporaryFolder folder;
    const CampaignFile campaign = cell_with(reversed_joints);
    const RobotProgram small = cell_program(campaign.controller);
    RobotProgram large = small;
    while (large.stops.size() < 1000) large.stops.push_back(small.stops[1]);
    const std::string path = folder.path("poses.src");
    const auto stale = [&](const RobotProgram& program) {
        return stale_program_files(path, ProgramFormat::Kuka, program);
    };
    EXPECT_TRUE(stale(large).empty());
    write_robot_program(path, ProgramFormat::Kuka, large, "", campaign, {});
    EXPECT_TRUE(stale(large).empty());
    EXPECT_EQ(stale(small),
              (std::vector<std::string>{folder.path("poses_1.src"), folder.path("poses_2.src"),
                                        folder.path("poses_3.src")}));
}

TEST(RobotPrograms, HaveNoJointWhereNoRobotIs) {
    const TemporaryFolder folder;
    const CampaignFile campaign = cell_with(reversed_joints);
    RobotProgram program = cell_program(campaign.controller);
    program.stops[1].joints[3] = to_radians(1e6);
    for (const ProgramFormat format : all_formats) {
        const std::string path = folder.path(file_of(format));
        const auto write = [&] { write_robot_program(path, format, program, "", campaign, {}); };
        EXPECT_EQ(input_error_of(write), "stop 'p1' has 1e+06 deg for J4, which no robot reaches");
    }
    EXPECT_EQ(folder.file_count(), 0U);
    EXPECT_NE(input_error_of([&] {
                  program_files(folder.path(".script"), ProgramFormat::Ur, program);
              }).find(".script: has no name before its ending"),
              std::string::npos);
}

TEST(RobotPrograms, NeedSixJointsButForRosAndCsv) {
    const CampaignFile crane = parse_campaign(
        "name: crane\nrobot:\n  joints: {q1: {limits_deg: [-90, 90]}, lift: {limits_mm: [0, "
        "500]}}\n"
        "  elements: [Rz q1, Tz lift, Tx 1 m]\n"
        "sensor: {kind: points, sigma_mm: 0.1, targets: {count: 3}}\n"
        "controller: {joints: {yaw: -q1, z: lift + 100 mm}}\n",
        "crane.yaml");
    const TemporaryFolder folder;
    RobotProgram program;
    program.joints = crane.controller;
    VectorXd q(2);
    q << 0.5, 0.2;
    program.settle = 0.5;
    program.stops = {{"p1", crane.controller.to_controller(q), true, 3}};
    write_robot_program(folder.path("a.csv"), ProgramFormat::Csv, program, "", crane, {});
    EXPECT_EQ(detail::read_file(folder.path("a.csv")),
              "name,yaw_deg,z_mm,dwell_s\np1,-28.647890,300.000000,6.5\n");
    for (const ProgramFormat format : {ProgramFormat::Csv, ProgramFormat::Ros2}) {
        const std::string path = folder.path(file_of(format));
        write_robot_program(path, format, program, "", crane, {});
        const auto stops = read_robot_program(path, format, crane.controller);
        EXPECT_LT((crane.controller.to_model(stops[0].joints) - q).norm(), 1e-8);
    }
    EXPECT_THROW(joint_steps(ProgramFormat::Fanuc, crane.controller), InputError);
}

}  // namespace
}  // namespace posewise::io
