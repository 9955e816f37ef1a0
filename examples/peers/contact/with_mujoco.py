"""MuJoCo: a flex of St. Venant-Kirchhoff tetrahedra for each body."""

import mujoco
import numpy as np

SETTINGS = {
    "default": dict(dt=0.002, radius=0.0005),
    "stiff": dict(dt=0.001, radius=0.002, solref=0.002),
}


def words(numbers):
    return " ".join(str(each) for each in np.ravel(numbers).tolist())


def record(scene, dt, radius, solref=None):
    contact = f'friction="{scene.friction} 0 0" condim="{3 if scene.friction else 1}"'
    if solref:
        contact += f' solref="{solref} 1" solimp="0.99 0.999 0.001"'
    parts = [f'<geom type="plane" size="50 50 1" zaxis="0 1 0" {contact}/>'] if scene.floor else []
    if scene.rod:
        ends = f"0 0 {-scene.rod.half} 0 0 {scene.rod.half}"
        parts.append(f"""<body name="rod" mocap="true" pos="{words(scene.rod.at(0))}">
            <geom type="capsule" fromto="{ends}" size="{scene.rod.radius}" {contact}/></body>""")
    for number, (nodes, tetrahedra) in enumerate(scene.bodies()):
        held = np.flatnonzero(scene.held[nodes])
        parts.append(f"""<flexcomp name="body{number}" type="direct" dim="3" radius="{radius}" mass="{scene.mass[nodes].sum()}"
            point="{words(scene.position[nodes])}" element="{words(tetrahedra)}">
            <contact selfcollide="none" {contact}/>
            <elasticity young="{scene.young}" poisson="0" damping="{scene.damping_time}"/>
            {f'<pin id="{words(held)}"/>' if len(held) else ""}</flexcomp>""")
    model = mujoco.MjModel.from_xml_string(f"""<mujoco>
        <size memory="2G"/>
        <option timestep="{dt}" gravity="{words(scene.gravity)}" cone="elliptic"><flag autoreset="disable"/></option>
        <worldbody>{"".join(parts)}</worldbody></mujoco>""")
    data = mujoco.MjData(model)
    data.qvel[:] = scene.velocity[~scene.held].ravel()  # held nodes have no degrees of freedom
    mujoco.mj_forward(model, data)

    def state():
        velocity = np.zeros((len(scene.mass), 3))
        velocity[~scene.held] = data.qvel.reshape(-1, 3)
        mujoco.mj_kinematics(model, data)
        mujoco.mj_flex(model, data)
        return [data.flexvert_xpos.copy(), velocity]

    def move(centre):
        data.mocap_pos[0] = centre

    return scene.record(f"MuJoCo {mujoco.__version__}", dt, lambda: mujoco.mj_step(model, data), state, move)
