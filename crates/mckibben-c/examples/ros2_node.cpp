// How a plant goes into a node of ROS 2, without ROS installed. The structs have the fields of the messages of that name, and
// `Node::on_timer` is what a timer of rclcpp would call; in a package, replace them by sensor_msgs/msg/joint_state.hpp,
// std_msgs/msg/float64_multi_array.hpp and create_wall_timer.
#include <mckibben.h>

#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

// sensor_msgs/JointState: angles in rad, velocities in rad/s, torques in N·m.
struct JointState {
    double stamp; // s
    std::vector<std::string> name;
    std::vector<double> position, velocity, effort;
};

// std_msgs/Float64MultiArray: a number for each valve, in the order of the plant's commands.
struct ValveCommand {
    std::vector<double> data;
};

static void check(mckibben_status status)
{
    if (status != MCKIBBEN_STATUS_OK) throw std::runtime_error(mckibben_last_error());
}

class Node {
public:
    Node(const char *scenario, double period, std::vector<std::string> joints) : period(period)
    {
        mckibben_options options = {};
        options.motion = MCKIBBEN_MOTION_SCENARIO;
        options.command_mode = "request";
        mckibben_plant *made = nullptr;
        check(mckibben_plant_from_file(scenario, &options, &made));
        plant.reset(made);
        outputs.resize(mckibben_output_count(made));
        for (std::size_t valve = 0; valve < mckibben_command_count(made); ++valve) {
            command.data.push_back(at_rest(valve));
        }
        state.name = joints;
        for (const std::string &joint : joints) {
            position.push_back(index_of(joint + ".angle"));
            velocity.push_back(index_of(joint + ".angular_velocity"));
            effort.push_back(index_of(joint + ".torque"));
        }
    }

    // Subscription: the last command holds until the next one. A number that is out of range is refused, and the valve stays.
    void on_command(const ValveCommand &message)
    {
        for (std::size_t valve = 0; valve < message.data.size(); ++valve) {
            if (mckibben_command(plant.get(), valve, message.data[valve]) != MCKIBBEN_STATUS_OK) {
                std::fprintf(stderr, "%s\n", mckibben_last_error());
            }
        }
    }

    // The request of a valve that adds no air: 0 (hold), or -1 (exhaust) of a valve that cannot hold.
    double at_rest(std::size_t valve) const
    {
        std::int32_t holds = 0;
        check(mckibben_command_accepts(plant.get(), valve, 0.0, &holds));
        return holds ? 0.0 : -1.0;
    }

    // Timer: one period of the plant, then the state of its joints is published. Steady steps allocate nothing; what happens for the
    // first time may, and steps of a joint at rest under friction do.
    const JointState &on_timer()
    {
        check(mckibben_advance(plant.get(), static_cast<double>(++ticks) * period, nullptr, 0));
        check(mckibben_outputs(plant.get(), outputs.data(), outputs.size()));
        check(mckibben_time(plant.get(), &state.stamp));
        state.position.clear(), state.velocity.clear(), state.effort.clear();
        for (std::size_t joint = 0; joint < state.name.size(); ++joint) {
            state.position.push_back(outputs[position[joint]]);
            state.velocity.push_back(outputs[velocity[joint]]);
            state.effort.push_back(outputs[effort[joint]]);
        }
        return state;
    }

    ValveCommand command;

private:
    std::size_t index_of(const std::string &output) const
    {
        std::size_t index = 0;
        check(mckibben_output_index(plant.get(), output.c_str(), &index));
        return index;
    }

    std::unique_ptr<mckibben_plant, void (*)(mckibben_plant *)> plant{nullptr, mckibben_plant_free};
    double period; // s
    long ticks = 0;
    std::vector<double> outputs;
    std::vector<std::size_t> position, velocity, effort;
    JointState state = {};
};

int main(int count, char **arguments)
try {
    const auto period = std::chrono::milliseconds(5);
    Node node(count > 1 ? arguments[1] : "examples/plant/arm.toml", 5e-3, {"shoulder", "elbow", "wrist"});
    auto wake = std::chrono::steady_clock::now();
    JointState last = {};
    for (int tick = 0; tick < 100; ++tick) {
        // The controller: the first actuator takes air until the shoulder is beyond 0.2 rad.
        node.command.data[0] = !last.position.empty() && last.position[0] > 0.2 ? node.at_rest(0) : 1.0;
        node.on_command(node.command);
        last = node.on_timer();
        wake += period;
        std::this_thread::sleep_until(wake);
    }
    for (std::size_t joint = 0; joint < last.name.size(); ++joint) {
        std::printf("%s %.6f rad, %.6f rad/s, %.6f N*m at %.3f s\n", last.name[joint].c_str(), last.position[joint],
                    last.velocity[joint], last.effort[joint], last.stamp);
    }
    return std::isfinite(last.position[0]) ? EXIT_SUCCESS : EXIT_FAILURE;
} catch (const std::exception &error) {
    std::fprintf(stderr, "%s\n", error.what());
    return EXIT_FAILURE;
}
