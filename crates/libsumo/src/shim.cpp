// libsumo's C++ functions as C functions. No exception leaves them: they return a status, and shim_error() has the text.
//
// Objects are named by SUMO's ids: a pointer to a vehicle could dangle. The strings are kept, so that they allocate
// nothing once they have grown.

#include <libsumo/libsumo.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include <ext/stdio_sync_filebuf.h>
#include <unistd.h>

#define API extern "C" __attribute__((visibility("default")))

using libsumo::Lane;
using libsumo::Simulation;
using libsumo::Vehicle;
using libsumo::VehicleType;

namespace {

enum Status { DONE = 0, REFUSED = 1, FAILED = 2, UNKNOWN = 3 };
enum Kind { DOUBLE = 1, INTEGER = 2, TEXT = 3, POSITION = 4, COLOUR = 5, LEADER = 6 };

std::string id, key, value, text, error;

template <class Call>
int guarded(Call call) {
    try {
        return call();
    } catch (const libsumo::TraCIException& e) {
        error = e.what();
        return REFUSED;
    } catch (const std::exception& e) {
        error = e.what();
    } catch (...) {
        error = "an exception without a text";
    }
    return FAILED;
}

// What the process still has to do at its end is done; SUMO's hundred libraries need not be taken down one by one, and
// another thread may be inside one of them.
void leave(int status, void*) {
    std::fflush(nullptr);
    _exit(status);
}

}  // namespace

struct Answer {
    int kind;
    int integer;
    double numbers[2];
    const char* text;
    size_t length;
    unsigned char colour[4];
};

namespace {

int number(Answer* to, double answer) {
    to->kind = DOUBLE;
    to->numbers[0] = answer;
    return DONE;
}

int integer(Answer* to, int answer) {
    to->kind = INTEGER;
    to->integer = answer;
    return DONE;
}

int words(Answer* to, std::string&& answer) {
    text = std::move(answer);
    to->kind = TEXT;
    to->text = text.data();
    to->length = text.size();
    return DONE;
}

int vehicle(int variable, double with, Answer* to) {
    switch (variable) {
        case libsumo::VAR_SPEED: return number(to, Vehicle::getSpeed(id));
        case libsumo::VAR_ANGLE: return number(to, Vehicle::getAngle(id));
        case libsumo::VAR_LANE_ID: return words(to, Vehicle::getLaneID(id));
        case libsumo::VAR_STOPSTATE: return integer(to, Vehicle::getStopState(id));
        case libsumo::VAR_SLOPE: return number(to, Vehicle::getSlope(id));
        case libsumo::VAR_DISTANCE: return number(to, Vehicle::getDistance(id));
        case libsumo::VAR_ROAD_ID: return words(to, Vehicle::getRoadID(id));
        case libsumo::VAR_TYPE: return words(to, Vehicle::getTypeID(id));
        case libsumo::VAR_IMPERFECTION: return number(to, Vehicle::getImperfection(id));
        case libsumo::VAR_TAU: return number(to, Vehicle::getTau(id));
        case libsumo::VAR_ACCEL: return number(to, Vehicle::getAccel(id));
        case libsumo::VAR_DECEL: return number(to, Vehicle::getDecel(id));
        case libsumo::VAR_SPEED_FACTOR: return number(to, Vehicle::getSpeedFactor(id));
        case libsumo::VAR_SPEEDSETMODE: return integer(to, Vehicle::getSpeedMode(id));
        case libsumo::VAR_MAXSPEED: return number(to, Vehicle::getMaxSpeed(id));
        case libsumo::VAR_PARAMETER: return words(to, Vehicle::getParameter(id, key));
        case libsumo::VAR_LEADER: {
            std::pair<std::string, double> ahead = Vehicle::getLeader(id, with);
            words(to, std::move(ahead.first));
            to->kind = LEADER;
            to->numbers[0] = ahead.second;
            return DONE;
        }
        case libsumo::VAR_POSITION: {
            const libsumo::TraCIPosition at = Vehicle::getPosition(id);
            to->kind = POSITION;
            to->numbers[0] = at.x;
            to->numbers[1] = at.y;
            return DONE;
        }
        case libsumo::VAR_COLOR: {
            const libsumo::TraCIColor colour = Vehicle::getColor(id);
            const int parts[4] = {colour.r, colour.g, colour.b, colour.a};
            to->kind = COLOUR;
            for (int i = 0; i < 4; i++) {
                to->colour[i] = static_cast<unsigned char>(parts[i]);
            }
            return DONE;
        }
        default: return UNKNOWN;
    }
}

int type(int variable, Answer* to) {
    switch (variable) {
        case libsumo::VAR_VEHICLECLASS: return words(to, VehicleType::getVehicleClass(id));
        case libsumo::VAR_LENGTH: return number(to, VehicleType::getLength(id));
        case libsumo::VAR_MASS: return number(to, VehicleType::getMass(id));
        case libsumo::VAR_ACCEL: return number(to, VehicleType::getAccel(id));
        case libsumo::VAR_EMERGENCY_DECEL: return number(to, VehicleType::getEmergencyDecel(id));
        case libsumo::VAR_ACTIONSTEPLENGTH: return number(to, VehicleType::getActionStepLength(id));
        case libsumo::VAR_PARAMETER: return words(to, VehicleType::getParameter(id, key));
        default: return UNKNOWN;
    }
}

int lane(int variable, Answer* to) {
    switch (variable) {
        case libsumo::VAR_MAXSPEED: return number(to, Lane::getMaxSpeed(id));
        case libsumo::VAR_FRICTION: return number(to, Lane::getFriction(id));
        default: return UNKNOWN;
    }
}

}  // namespace

API void shim_version(int* api, const char** name, size_t* length) {
    static std::pair<int, std::string> version;
    version = Simulation::getVersion();
    *api = version.first;
    *name = version.second.data();
    *length = version.second.size();
}

API void shim_error(const char** what, size_t* length) {
    *what = error.data();
    *length = error.size();
}

// From now on the standard streams of C and C++, and so all that SUMO and its libraries print, go to a file; descriptors
// stay what they are. The process ends without taking down SUMO's libraries.
API int shim_prepare(const char* home, const char* log) {
    return guarded([&] {
        // For good: SUMO prints until the very end.
        std::FILE* file = std::fopen(log, "ae");
        if (file == nullptr) {
            error = std::strerror(errno);
            return REFUSED;
        }
        stdout = file;
        stderr = file;
        auto* buffer = new __gnu_cxx::stdio_sync_filebuf<char>(file);
        std::cout.rdbuf(buffer);
        std::cerr.rdbuf(buffer);
        std::clog.rdbuf(buffer);
        on_exit(leave, nullptr);
        if (home != nullptr) {
            setenv("SUMO_HOME", home, 1);
        }
        return DONE;
    });
}

// What fails here SUMO's program says itself, and so does this.
API int shim_load(const char* const* arguments, size_t count) {
    const int status = guarded([&] {
        Simulation::load(std::vector<std::string>(arguments, arguments + count));
        if (!Simulation::isLoaded()) {
            error = "SUMO has loaded nothing";
            return REFUSED;
        }
        return DONE;
    });
    if (status != DONE && error != "Process Error" && !error.empty()) {
        std::cerr << "Error: " << error << std::endl;
    }
    std::cout.flush();
    return status;
}

API int shim_step() {
    const int status = guarded([] {
        Simulation::step();
        return DONE;
    });
    if (status != DONE) {
        std::cerr << "Error: " << error << std::endl;
    }
    return status;
}

API int shim_close() {
    const int status = guarded([] {
        Simulation::close("TraCI requested termination.");
        return DONE;
    });
    std::cout.flush();
    return status;
}

API int shim_end(double* end_s) {
    return guarded([&] {
        *end_s = Simulation::getEndTime();
        return DONE;
    });
}

API int shim_option(const char* name, size_t length, Answer* to) {
    return guarded([&] {
        key.assign(name, length);
        return words(to, Simulation::getOption(key));
    });
}

// Time, step and number of vehicles expected.
API int shim_clock(double* time_s, double* step_s, int* expected) {
    return guarded([&] {
        *time_s = Simulation::getTime();
        *step_s = Simulation::getDeltaT();
        *expected = Simulation::getMinExpectedNumber();
        return DONE;
    });
}

// Ids of one kind, one call of `each` per id: 0 departed, 1 arrived, 2 teleport begins, 3 ends, 4 colliding, 5 on the
// road, 6 the pairs of collisions one after the other.
API int shim_ids(int kind, void (*each)(void*, const char*, size_t), void* into) {
    return guarded([&] {
        std::vector<std::string> ids;
        switch (kind) {
            case 0: ids = Simulation::getDepartedIDList(); break;
            case 1: ids = Simulation::getArrivedIDList(); break;
            case 2: ids = Simulation::getStartingTeleportIDList(); break;
            case 3: ids = Simulation::getEndingTeleportIDList(); break;
            case 4: ids = Simulation::getCollidingVehiclesIDList(); break;
            case 5: ids = Vehicle::getIDList(); break;
            default:
                for (const libsumo::TraCICollision& collision : Simulation::getCollisions()) {
                    ids.push_back(collision.collider);
                    ids.push_back(collision.victim);
                }
        }
        for (const std::string& each_id : ids) {
            each(into, each_id.data(), each_id.size());
        }
        return DONE;
    });
}

API int shim_get(int domain, int variable, const char* name, size_t length, const char* with, size_t with_length,
                 double with_number, Answer* to) {
    return guarded([&] {
        id.assign(name, length);
        key.assign(with, with_length);
        switch (domain) {
            case libsumo::CMD_GET_VEHICLE_VARIABLE: return vehicle(variable, with_number, to);
            case libsumo::CMD_GET_VEHICLETYPE_VARIABLE: return type(variable, to);
            case libsumo::CMD_GET_LANE_VARIABLE: return lane(variable, to);
            default: return static_cast<int>(UNKNOWN);
        }
    });
}

API int shim_previous_speed(const char* name, size_t length, double speed_mps, double acceleration_mps2) {
    return guarded([&] {
        id.assign(name, length);
        Vehicle::setPreviousSpeed(id, speed_mps, acceleration_mps2);
        return DONE;
    });
}

API int shim_set(int variable, const char* name, size_t length, double number) {
    return guarded([&] {
        id.assign(name, length);
        switch (variable) {
            case libsumo::VAR_SPEED: Vehicle::setSpeed(id, number); return DONE;
            case libsumo::VAR_TAU: Vehicle::setTau(id, number); return DONE;
            case libsumo::VAR_IMPERFECTION: Vehicle::setImperfection(id, number); return DONE;
            case libsumo::VAR_ACCEL: Vehicle::setAccel(id, number); return DONE;
            case libsumo::VAR_DECEL: Vehicle::setDecel(id, number); return DONE;
            case libsumo::VAR_SPEED_FACTOR: Vehicle::setSpeedFactor(id, number); return DONE;
            case libsumo::VAR_SPEEDSETMODE: Vehicle::setSpeedMode(id, static_cast<int>(number)); return DONE;
            default: return UNKNOWN;
        }
    });
}

API int shim_set_parameter(const char* name, size_t length, const char* which, size_t which_length, const char* given,
                           size_t given_length) {
    return guarded([&] {
        id.assign(name, length);
        key.assign(which, which_length);
        value.assign(given, given_length);
        Vehicle::setParameter(id, key, value);
        return DONE;
    });
}

API int shim_set_colour(const char* name, size_t length, const unsigned char* rgba) {
    return guarded([&] {
        id.assign(name, length);
        Vehicle::setColor(id, libsumo::TraCIColor(rgba[0], rgba[1], rgba[2], rgba[3]));
        return DONE;
    });
}
