"""The closed form of the fastest stream that an agent can walk against.

Eq. 9 in a uniform stream: an agent that walks with v_B straight against v_F moves at
(m_a v_B - tau m_c v_F) / (m_a + tau m_c), which is positive if and only if v_F < v_B m_a / (tau m_c). The mean contact
mass m_c = rho h pi r_c^2 does not depend on the particles' size; r_c is the contact distance and h the depth.
"""

import math

from wade import UsageError

FREE_SHARE = 0.989  # walking speed of a free agent over its desired speed, with the speed rule `pi`


def ends(value):
    """(lowest, highest) of tau or a mass as a resolved scene has it: a number, or limits between which it is drawn."""
    return (value["min"], value["max"]) if isinstance(value, dict) else (value, value)


def middle(value):
    """Mean of what is drawn."""
    return sum(ends(value)) / 2


def in_words(value):
    """"0.2", or "0.4 to 0.8" of what is drawn."""
    low, high = ends(value)
    return f"{low:g}" if low == high else f"{low:g} to {high:g}"


def given_tau(group):
    """Returns tau of a group of a resolved scene. Raises UsageError for groups without tau (response `measured`)."""
    if "tau" not in group:
        raise UsageError(f"/crowd/groups: \"{group.get('name', '')}\" has no tau, as /crowd/response is \"measured\": Eq. 9 and its "
                         "limits are of people with a given tau; give the group one, or set /crowd/response to \"paper\"")
    return group["tau"]


def walking_speed(scene):
    """v_B of the first group's agents where nothing holds them up, m/s."""
    share = FREE_SHARE if scene["crowd"].get("speed_rule", "pi") == "pi" else 1
    return share * scene["crowd"]["groups"][0]["desired_speed_m_s"]


def contact_distance(coupling):
    """m, as the contact rule says."""
    agent, particle = coupling["agent_radius_m"], coupling["particle_radius_m"]
    return agent + particle if coupling["contact_rule"] == "sum" else abs(agent - particle)


def contact_mass(scene, depth=None):
    """m_c in water of a depth, by default the scene's, kg."""
    area = math.pi * contact_distance(scene["coupling"]) ** 2
    return scene["fluid"]["rest_density_kg_m3"] * (depth or scene["channel"]["depth_m"]) * area


def limit_velocity(mass, walking, tau, contact):
    """Returns the v_F that an agent just withstands, m/s; infinite for tau 0."""
    return math.inf if tau == 0 else walking * mass / (tau * contact)


def limits_of(scene, depth=None):
    """(lowest, highest) limit of the agents of the first group, m/s; two numbers only if tau or the mass is drawn."""
    group, contact, walking = scene["crowd"]["groups"][0], contact_mass(scene, depth), walking_speed(scene)
    light, heavy = ends(group["mass_kg"])
    enduring, yielding = ends(given_tau(group))
    return limit_velocity(light, walking, yielding, contact), limit_velocity(heavy, walking, enduring, contact)


def loss_velocity(scene, tau):
    """Returns the v_F, m/s, that carries the first group, on average, to the outfall while it heads straight across.

    With k = tau m_c / (m_a + tau m_c) an agent moves at (1 - k) v_B across the channel and drifts at k v_F.
    tau: a number; a mass that is drawn counts with its mean.
    """
    if tau == 0:
        return math.inf
    group, channel = scene["crowd"]["groups"][0], scene["channel"]
    start = group["start"]
    way = start["x_m"] + (group["columns"] - 1) / 2 * start["pitch_x_m"] - channel["x_min_m"]
    width = channel["z_max_m"] - channel["z_min_m"]
    return way / width * walking_speed(scene) * middle(group["mass_kg"]) / (tau * contact_mass(scene))


def of_limit(scene, tau=None, velocity=None, depth=None):
    """v_F over the limit for the first group of a scene: above 1 an agent cannot walk against the stream.

    A tau or a mass that is drawn counts with its mean.
    """
    group = scene["crowd"]["groups"][0]
    tau = middle(given_tau(group) if tau is None else tau)
    velocity = scene["channel"]["velocity_m_s"] if velocity is None else velocity
    limit = limit_velocity(middle(group["mass_kg"]), walking_speed(scene), tau, contact_mass(scene, depth))
    return velocity / limit if limit > 0 else math.inf
