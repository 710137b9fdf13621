// An arm of three joints and six actuators on one tank, moved by its scenario: the program commands the valves, saves a state, tries
// two commands from there, and goes on with the one that lifts the hand higher.
//
//     c++ -std=c++17 arm.cpp -lmckibben_c -o arm && ./arm examples/plant/arm.toml
#include <mckibben.h>

#include <cstdio>
#include <cstdlib>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

void check(mckibben_status status)
{
    if (status != MCKIBBEN_STATUS_OK) throw std::runtime_error(mckibben_last_error());
}

struct Free {
    void operator()(mckibben_plant *plant) const { mckibben_plant_free(plant); }
};

// A plant with the lifetime of a C++ object.
class Plant {
public:
    Plant(const std::string &path, const mckibben_options &options)
    {
        mckibben_plant *made = nullptr;
        check(mckibben_plant_from_file(path.c_str(), &options, &made));
        plant.reset(made);
        outputs.resize(mckibben_output_count(made));
    }

    // The index of the command of an actuator. Its name lists the actuators that the valve feeds, then the mode: "biceps.request",
    // "flexor+extensor.set_point".
    std::size_t command_of(const std::string &actuator) const
    {
        for (std::size_t index = 0; index < mckibben_command_count(plant.get()); ++index) {
            mckibben_command_info info;
            check(mckibben_command_describe(plant.get(), index, &info));
            const std::string name = info.name;
            std::istringstream fed(name.substr(0, name.rfind('.')));
            for (std::string its; std::getline(fed, its, '+');) {
                if (its == actuator) return index;
            }
        }
        throw std::runtime_error("no command of " + actuator);
    }

    void command(std::size_t index, double number) { check(mckibben_command(plant.get(), index, number)); }

    void advance(double until) { check(mckibben_advance(plant.get(), until, nullptr, 0)); }

    double output(const char *name)
    {
        std::size_t index = 0;
        check(mckibben_output_index(plant.get(), name, &index));
        check(mckibben_outputs(plant.get(), outputs.data(), outputs.size()));
        return outputs[index];
    }

    std::vector<double> save()
    {
        std::vector<double> numbers(mckibben_state_size(plant.get()));
        check(mckibben_save(plant.get(), numbers.data(), numbers.size()));
        return numbers;
    }

    void restore(const std::vector<double> &numbers)
    {
        check(mckibben_restore(plant.get(), numbers.data(), numbers.size()));
    }

private:
    std::unique_ptr<mckibben_plant, Free> plant;
    std::vector<double> outputs;
};

} // namespace

int main(int count, char **arguments)
try {
    mckibben_options options = {};
    options.motion = MCKIBBEN_MOTION_SCENARIO;
    options.command_mode = "request";
    Plant arm(count > 1 ? arguments[1] : "examples/plant/arm.toml", options);
    const std::size_t deltoid = arm.command_of("deltoid"), biceps = arm.command_of("biceps");

    arm.command(deltoid, 1.0);
    arm.advance(0.1);
    const std::vector<double> here = arm.save();

    arm.command(biceps, 1.0);
    arm.advance(0.3);
    const double bent = arm.output("elbow.angle");

    arm.restore(here);
    arm.command(biceps, 0.0);
    arm.advance(0.3);
    const double straight = arm.output("elbow.angle");

    // The first way again: to the same bits.
    arm.restore(here);
    arm.command(biceps, 1.0);
    arm.advance(0.3);
    const bool equal = arm.output("elbow.angle") == bent;
    std::printf("elbow %.17g rad bent, %.17g rad straight; again %s\n", bent, straight, equal ? "equal" : "different");
    return equal ? EXIT_SUCCESS : EXIT_FAILURE;
} catch (const std::exception &error) {
    std::fprintf(stderr, "%s\n", error.what());
    return EXIT_FAILURE;
}
