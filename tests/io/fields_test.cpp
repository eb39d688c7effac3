#include "../../src/io/format/fields.hpp"

#include <gtest/gtest.h>

#include "support/temporary_folder.hpp"

namespace posewise::detail {
namespace {

enum class Colour { Red, Green };
constexpr Names<Colour, 2> colours{{{Colour::Red, "red"}, {Colour::Green, "green"}}};

struct Part {
    std::string name;
    double length = 0;
};

struct Record {
    Index count = 0;
    double bound = 0;
    std::vector<Colour> colours;
    std::optional<std::uint64_t> seed;
    std::vector<double> shares;
    std::vector<Part> parts;
};

void record_fields(const Fields& file, Record& record) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    file("count", record.count, Count{1, 10});
    file("bound", record.bound, Number{.null = infinity});
    file("colours", record.colours, OneOf(colours));
    file.optional("seed", record.seed.has_value(), record.seed);
    const Fields inner = file["inner"];
    inner("shares", record.shares, Number{.above = 0, .most = 1});
    file.list("parts", record.parts, [](const Fields& item, Part& part) {
        item("name", part.name);
        item("length_m", part.length, Number{.least = 0});
        item.check("name", part.name != "nobody", "must be somebody");
    });
}

const char* const text =
    R"({"count":3,"bound":null,"colours":["green","red"],"seed":7,"inner":{"shares":[0.5,1.0]},)"
    R"("parts":[{"name":"a","length_m":0.0},{"name":"b","length_m":2.5}]})";

Record read_record(const Json& json) {
    Record record;
    record_fields(Fields(JsonValue(json, "r.json")), record);
    return record;
}

TEST(Fields, AreWrittenAsTheyAreRead) {
    Record record = read_record(Json::parse(text));
    EXPECT_EQ(record.bound, std::numeric_limits<double>::infinity());
    EXPECT_EQ(record.seed, 7U);
    EXPECT_EQ(record.colours, (std::vector{Colour::Green, Colour::Red}));
    EXPECT_EQ(record.parts[1].length, 2.5);
    Json json;
    record_fields(Fields(json), record);
    EXPECT_EQ(json.dump(), text);
    record.seed.reset();
    Json without;
    record_fields(Fields(without), record);
    EXPECT_FALSE(without.contains("seed"));
    EXPECT_FALSE(read_record(without).seed);
}

TEST(Fields, SayWhereWhatIsReadBreaksWhichRule) {
    const auto error_with = [](const char* pointer, const Json& value) {
        Json json = Json::parse(text);
        json[Json::json_pointer(pointer)] = value;
        return testing::input_error_of([&] { read_record(json); });
    };
    EXPECT_EQ(error_with("/count", 11), "r.json: count: is 11; must be at most 10");
    EXPECT_EQ(error_with("/bound", "x"), "r.json: bound: is of type string; must be a number");
    EXPECT_EQ(error_with("/seed", nullptr),
              "r.json: seed: is of type null; must be a whole number that is not negative");
    EXPECT_EQ(error_with("/colours/1", "blue"),
              "r.json: colours[1]: is 'blue'; must be red or green");
    EXPECT_EQ(error_with("/inner/shares/0", 0), "r.json: inner.shares[0]: is 0; must be above 0");
    EXPECT_EQ(error_with("/inner/shares/0", 1.5),
              "r.json: inner.shares[0]: is 1.5; must be at most 1");
    EXPECT_EQ(error_with("/inner", 1), "r.json: inner: is of type number; must be an object");
    EXPECT_EQ(error_with("/parts/1/length_m", -1),
              "r.json: parts[1].length_m: is -1; must be at least 0");
    EXPECT_EQ(error_with("/parts/0/name", "nobody"),
              "r.json: parts[0].name: is 'nobody'; must be somebody");
    EXPECT_EQ(error_with("/parts/0", Json::object()),
              "r.json: parts[0].name: is missing; must be there as posewise writes it");
}

}  // namespace
}  // namespace posewise::detail
