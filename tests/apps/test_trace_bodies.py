"""Rays through bodies and lenses, and their image, against closed forms; rejected input."""

import unittest

import numpy as np

from program import DATA, WHOLE, datasets
from refusing import RefusingTest

GLASS = [1.5, 0, 0, 0]
PARALLEL = {"field": "homogeneous", "light": "line", "max_length": 100}


def plane(z):
    return [0, 0, z, 0, 0, 1]


class BodiesTest(RefusingTest):
    def trace(self, **keys):
        self.output = self.call("trace", **keys, out="rays.h5").stdout
        return datasets(self.folder / "rays.h5")

    def ends(self, found):
        return np.stack([found["exit/" + axis] for axis in "xyz"], axis=-1)


class Bodies(BodiesTest):
    def test_ball_lens(self):
        """A ray refracted twice leaves at its distance h from the centre, deflected by
        2 (asin h - asin h/n)."""
        found = self.trace(**PARALLEL, ball=[0, 0, 0, 1, *GLASS], origin=[0, 0, -3], beam_radius=0.95,
                           stop_plane=plane(2))
        h = found["start/x"]
        turn = 2 * (np.arcsin(h) - np.arcsin(h / 1.5))
        np.testing.assert_allclose(found["exit/dx"], -np.sin(turn), atol=1e-13)
        np.testing.assert_allclose(found["exit/x"], h / np.cos(turn) - 2 * np.tan(turn), atol=1e-13)
        after = (2 - h * np.sin(turn)) / np.cos(turn)
        path = 3 + after - 2 * np.sqrt(1 - h**2) + 3 * np.sqrt(1 - (h / 1.5)**2)
        np.testing.assert_allclose(found["optical_path"], path, rtol=1e-13)

    def test_cylinder_lens(self):
        """In a plane normal to its axis, a cylinder deflects rays as a ball does."""
        found = self.trace(**PARALLEL, cylinder=[0, -2, 0, 0, 2, 0, 1, *GLASS], origin=[0, 0.3, -3], beam_radius=0.95,
                           stop_plane=plane(2))
        h = found["start/x"]
        turn = 2 * (np.arcsin(h) - np.arcsin(h / 1.5))
        np.testing.assert_allclose(found["exit/dx"], -np.sin(turn), atol=1e-13)
        np.testing.assert_allclose(found["exit/x"], h / np.cos(turn) - 2 * np.tan(turn), atol=1e-13)
        np.testing.assert_allclose(found["exit/y"], 0.3, atol=1e-14)

    def test_turned_plate_displaces_rays(self):
        """A plate of thickness t, turned by a, displaces rays by t sin a (1 - cos a / (n cos b))."""
        found = self.trace(**PARALLEL, block=[-3, -3, -0.4, 3, 3, 0.4, *GLASS], block_turns=[0, 0.6, 0],
                           origin=[0, 0, -3], beam_radius=0.5, stop_plane=plane(3))
        inner = np.arcsin(np.sin(0.6) / 1.5)
        moved = 0.8 * np.sin(0.6) * (1 - np.cos(0.6) / (1.5 * np.cos(inner)))
        np.testing.assert_allclose(found["exit/x"], found["start/x"] + moved, atol=1e-13)
        np.testing.assert_allclose(found["exit/dx"], 0, atol=1e-14)

    def test_lens_of_two_half_balls_is_a_ball(self):
        ball, lens = (self.trace(**PARALLEL, **body, origin=[0, 0, -3], beam_radius=0.9, stop_plane=plane(2))
                      for body in ({"ball": [0, 0, 0, 1, *GLASS]}, {"lens": [0, 0, -1, 1, 1, -1, 2, *GLASS]}))
        np.testing.assert_allclose(self.ends(lens), self.ends(ball), atol=1e-13)
        np.testing.assert_allclose(lens["optical_path"], ball["optical_path"], rtol=1e-13)

    def test_render_sees_that_ball_too(self):
        keys = {"stage_box": [-3, -3, -3, 3, 3, 3], "field": "homogeneous", "sensor": "area", "sensor_at": [0, 0, 3],
                "sensor_size": [4, 4], "pixels": [1, 1], "point_light": [0, 0, -2.5, 1], "method": "light",
                "samples": 200_000 if WHOLE else 80_000, "threads": 1}
        dim = [1.5, 0.5, 0.1, 0]  # scattering and absorbing
        totals = []
        for body in ({"ball": [0, 0, 0, 1, *dim]}, {"lens": [0, 0, -1, 1, 1, -1, 2, *dim]}):
            self.call("render", **keys, **body, out="light.h5")
            found = datasets(self.folder / "light.h5")
            totals.append((found["total"], found["total_error"]))
        (ball, ball_error), (lens, lens_error) = totals
        self.assertLess(abs(ball - lens), 4 * np.hypot(ball_error, lens_error))
        self.assertLess(lens_error / lens, 0.03)

    def test_render_has_mirrors_and_absorbing_bodies(self):
        """A ball of half the radius of a beam takes a quarter of its light; a mirror in even light is not seen."""
        keys = {"stage_box": [-3, -3, -3, 3, 3, 3], "threads": 1, "samples": 40_000}
        beam = {"beam_light": [0, 0, -3, 0, 0, 1, 2, 1], "sensor": "area", "sensor_at": [0, 0, 3],
                "sensor_size": [5, 5], "pixels": [1, 1]}
        for word, where in (("absorb", "absorbed_body"), ("mirror", "specular")):
            self.call("render", **keys, **beam, ball=[0, 0, 0, 1, *GLASS], ball_face=word, out="light.h5")
            found = datasets(self.folder / "light.h5")
            error = found["energy/" + where + "_error"]
            self.assertLess(abs(found["energy/" + where] - 0.25), 4 * error + 1e-3)
            self.assertLess(error, 0.005)
            if word == "absorb":  # some light that grazes a mirror reaches the sensor
                self.assertLess(abs(found["total"] - 0.75), 4 * found["total_error"] + 1e-3)
        self.call("render", **keys, environment=1, sensor="camera", sensor_at=[0, 0, 2.9], sensor_direction=[0, 0, -1],
                  sensor_up=[0, 1, 0], field_of_view=1, pixels=[16, 16], block=[-0.5, -0.5, 0, 0.6, 0.7, 0.5, *GLASS],
                  block_turns=[0.3, 0.5, 0.1], block_face="mirror", out="even.h5")
        np.testing.assert_allclose(datasets(self.folder / "even.h5")["image"], 1, atol=1e-12)

    def test_thick_lens_and_cemented_pair_on_the_axis(self):
        """Back focal distances agree with paraxial refraction, n' u' = n u - y (n' - n)/R."""
        for lenses in ([[0, 0, 0, 1, 6, -4, 0.6, 1.52, 0, 0, 0]],
                       [[0, 0, 0, 1, -6, 4, 0.6, 1.52, 0, 0, 0]],
                       [[0, 0, 0, 1, 6, -4, 0.6, 1.52, 0, 0, 0], [0, 0, 0.6, 1, -4, -40, 0.3, 1.62, 0, 0, 0]]):
            y, nu, index = 1, 0, 1
            for lens in lenses:
                nu -= y * (lens[7] - index) / lens[4]
                index = lens[7]
                y += nu / index * lens[6]
            nu -= y * (1 - index) / lens[5]
            back = lens[2] + lens[6]
            found = self.trace(**PARALLEL, lens=sum(lenses, []), origin=[0, 0, -1], beam_radius=1e-4,
                               stop_plane=plane(back + 1), image_plane=plane(back))
            self.assertAlmostEqual(found["image/focus"] / (-y / nu), 1, delta=1e-7)
            np.testing.assert_allclose(found["optical_path"][5], 2 + sum(lens[6] * lens[7] for lens in lenses),
                                       rtol=1e-14)

    def test_plate(self):
        """Rays are shifted by d sin(t - t')/cos(t') and attenuated by Fresnel reflection and the medium."""
        found = self.trace(**PARALLEL, block=[-9, -9, 0, 9, 9, 1, 1.5, 0.2, 0.1, 0], ray_count=1,
                           direction=[np.sin(0.7), 0, np.cos(0.7)], origin=[-1, 0, -1], stop_plane=plane(4))
        inside = np.arcsin(np.sin(0.7) / 1.5)
        np.testing.assert_allclose(found["exit/x"], -1 + 4 * np.tan(0.7) + np.tan(inside), rtol=1e-13)
        s = (np.sin(0.7 - inside) / np.sin(0.7 + inside))**2
        p = (np.tan(0.7 - inside) / np.tan(0.7 + inside))**2
        left = (1 - (s + p) / 2)**2 * np.exp(-0.3 / np.cos(inside))
        np.testing.assert_allclose(found["transmittance"], left, rtol=1e-13)

    def test_total_reflection(self):
        """A steep ray is reflected to and fro in a plate without loss."""
        found = self.trace(**PARALLEL, block=[-9, -9, 0, 9, 9, 1, *GLASS], ray_count=1, direction=[1, 0, 1],
                           origin=[0, 0, 0.25], stop_plane=[7, 0, 0, 1, 0, 0])
        np.testing.assert_allclose(self.ends(found), [[7, 0, 0.75]], atol=1e-13)
        self.assertEqual(found["transmittance"], 1)
        np.testing.assert_allclose(found["optical_path"], 1.5 * 7 * np.sqrt(2), rtol=1e-14)

    def test_bodies_in_bodies(self):
        """An inner body of the same index has no effect; a bubble has."""
        keys = {**PARALLEL, "origin": [0, 0.1, -3], "beam_radius": 0.8, "stop_plane": plane(2)}
        plain = self.trace(**keys, ball=[0, 0, 0, 1, *GLASS])
        same = self.trace(**keys, ball=[0, 0, 0, 1, *GLASS, 0.2, 0, 0.1, 0.3, *GLASS])
        np.testing.assert_allclose(self.ends(same), self.ends(plain), atol=1e-13)
        hollow = self.trace(**keys, ball=[0, 0, 0, 1, *GLASS, 0, 0, 0, 0.999999, 1, 0, 0, 0])
        np.testing.assert_allclose(hollow["exit/x"][:1], keys["beam_radius"] * -1, atol=0.01)
        self.assertGreater(np.abs(self.ends(hollow) - self.ends(plain)).max(), 0.1)

    def test_rod_of_parabolic_index(self):
        """Inside, x = h cos(alpha sigma), sigma = L/beta; the plane face conserves v_x."""
        found = self.trace(**PARALLEL | {"field": "parabolic"}, index=1.6, alpha=0.5, body_lens=[0, 0, 0, 0.9, 0, 0, 3],
                           origin=[0, 0, -1], beam_radius=0.4, stop_plane=plane(4))
        h = found["start/x"]
        turn = 0.5 * 3 / np.sqrt(1.6**2 - (0.5 * h)**2)
        vx = -h * 0.5 * np.sin(turn)
        np.testing.assert_allclose(found["exit/dx"], vx, atol=1e-10)
        np.testing.assert_allclose(found["exit/x"], h * np.cos(turn) + vx / np.sqrt(1 - vx**2), atol=1e-9)

    def test_from_inside_of_a_rod(self):
        """A ray from inside crosses the far face once."""
        found = self.trace(field="parabolic", index=1.5, alpha=1e-6, body_lens=[0, 0, 0, 0.9, 0, 0, 3], light="line",
                           ray_count=3, beam_radius=0.2, origin=[0, 0, 1], stop_plane=plane(4), max_length=20)
        np.testing.assert_allclose(found["optical_path"], 2 * 1.5 + 1, rtol=1e-9)
        np.testing.assert_allclose(found["transmittance"], 1 - 0.2**2, rtol=1e-9)

    def test_luneburg_in_air_has_no_surface(self):
        keys = {**PARALLEL | {"field": "luneburg"}, "origin": [0, 0, -2], "beam_radius": 0.9, "stop_plane": plane(1)}
        bare, body = self.trace(**keys), self.trace(**keys, body_sphere=[0, 0, 0, 1])
        np.testing.assert_allclose(self.ends(body), np.tile([0, 0, 1], (11, 1)), atol=1e-8)
        np.testing.assert_allclose(body["optical_path"], bare["optical_path"], rtol=1e-10)
        np.testing.assert_allclose(body["transmittance"], 1, atol=1e-12)

    def test_luneburg_in_water_keeps_the_distance_from_the_centre(self):
        """The sphere and the field conserve n r sin(angle): rays leave at their initial distance."""
        found = self.trace(**PARALLEL | {"field": "luneburg"}, body_sphere=[0, 0, 0, 1], index_around=1.33,
                           origin=[0, 0, -2], beam_radius=0.7, stop_plane=plane(2))
        along = np.stack([found["exit/d" + axis] for axis in "xyz"], axis=-1)
        np.testing.assert_allclose(np.linalg.norm(np.cross(self.ends(found), along), axis=1),
                                   abs(found["start/x"]), atol=1e-9)

    def test_field_around_bodies(self):
        """A ray from a guide into a block keeps the transverse part of n times its direction."""
        keys = {**PARALLEL | {"field": "parabolic"}, "index": 1.5, "alpha": 0.3, "ray_count": 1, "origin": [0.4, 0, 0],
                "stop_plane": plane(1)}
        found = self.trace(**keys, block=[-1, -1, 0.5, 1, 1, 1, 1.7, 0, 0, 0])
        guide = self.trace(**keys | {"stop_plane": plane(0.5)})
        momentum = guide["exit/dx"] * np.sqrt(1.5**2 - (0.3 * guide["exit/x"])**2)
        np.testing.assert_allclose(found["exit/dx"], momentum / 1.7, rtol=1e-9)

class Contact(BodiesTest):
    AXIS = {**PARALLEL, "ray_count": 1, "origin": [0.1, 0.2, -1]}

    def through(self, *indices):
        """Returns the transmittance at normal incidence through a series of media."""
        return np.prod([1 - ((a - b) / (a + b))**2 for a, b in zip(indices, indices[1:])])

    def test_field_body_and_block_share_a_face(self):
        for gap, indices in (0, (1, 1.5, 1.3, 1)), (1e-9, (1, 1.5, 1, 1.3, 1)):
            found = self.trace(**self.AXIS | {"field": "parabolic", "origin": [-0.3, 0, -1]}, index=1.5, alpha=1e-6,
                               body_box=[-1, -1, 0, 1, 1, 0.5], block=[-1, -1, 0.5 + gap, 1, 1, 3, 1.3, 0, 0, 0],
                               stop_plane=plane(5))
            np.testing.assert_allclose(found["optical_path"], 7, atol=1e-9)
            np.testing.assert_allclose(found["transmittance"], self.through(*indices), rtol=1e-10)

    def test_a_body_flush_with_the_one_around_it(self):
        found = self.trace(**self.AXIS, block=[-1, -1, 0, 1, 1, 1, 1.3, 0, 0, 0, -0.5, -0.5, 0.3, 0.5, 0.5, 1, *GLASS],
                           stop_plane=plane(4))
        np.testing.assert_allclose(found["optical_path"], 1 + 0.3 * 1.3 + 0.7 * 1.5 + 3, rtol=1e-14)
        np.testing.assert_allclose(found["transmittance"], self.through(1, 1.3, 1.5, 1), rtol=1e-14)

    def test_many_plates_in_contact(self):
        for count in 1, 2, 50:
            rows = [[-1, -1, 0.1 * i, 1, 1, 0.1 * (i + 1), 1.5 if i % 2 else 1.2, 0, 0, 0] for i in range(count)]
            found = self.trace(**self.AXIS, block=sum(rows, []), stop_plane=plane(7))
            indices = [1, *(row[6] for row in rows), 1]
            np.testing.assert_allclose(found["transmittance"], self.through(*indices), rtol=1e-12)
            np.testing.assert_allclose(found["optical_path"], 8 + 0.1 * (sum(indices[1:-1]) - count), rtol=1e-13)

    def test_a_stop_plane_on_a_face_ends_rays_before_it(self):
        found = self.trace(**self.AXIS, block=[-1, -1, 0.1, 1, 1, 0.7, *GLASS], stop_plane=plane(0.1 + 0.6))
        self.assertEqual(found["status"], 0)
        np.testing.assert_allclose(found["optical_path"], 1.1 + 0.6 * 1.5, rtol=1e-14)
        np.testing.assert_allclose(found["transmittance"], 0.96, rtol=1e-14)

    def test_huge_radii_are_planes(self):
        keys = {**PARALLEL, "light": "disk", "ray_count": 50, "origin": [0, 0, -20], "stop_plane": plane(50),
                "max_length": 1000, "image_plane": plane(100), "refocus": True}
        flat = self.trace(**keys, lens=[0, 0, 0, 12.5, 60, 0, 5, 1.5168, 0, 0, 0])
        self.assertAlmostEqual(float(flat["image/distance"]), 17.796409, delta=1e-6)
        for radius in 1e14, -1e15, 1e17, 1e50:
            found = self.trace(**keys, lens=[0, 0, 0, 12.5, 60, radius, 5, 1.5168, 0, 0, 0])
            np.testing.assert_allclose(found["image/distance"], flat["image/distance"], rtol=1e-9)
            np.testing.assert_allclose(found["image/spot_radius"], flat["image/spot_radius"], rtol=1e-7)

    def test_a_rod_with_a_round_end(self):
        """The far half of the sphere at its end does not cut the rod."""
        for back in (-1, -0.6):
            found = self.trace(**PARALLEL, ray_count=1, origin=[0, 0, -1], lens=[0, 0, 0, 0.5, 0, back, 5, *GLASS],
                               stop_plane=plane(8))
            np.testing.assert_allclose(found["optical_path"], 11.5, rtol=1e-14)


class Image(BodiesTest):
    def test_aplanatic_points(self):
        """Rays from R/n off a ball's centre appear to come from n R: no spot and, by Fermat, no path
        differences."""
        found = self.trace(field="homogeneous", light="cone", half_angle=1.5, origin=[0, 0, -2 / 3],
                           ball=[0, 0, 0, 1, *GLASS], ray_count=100, stop_sphere=[0, 0, 0, 3], max_length=20,
                           image_plane=plane(-1.4), refocus=True)
        self.assertAlmostEqual(float(found["image/distance"]), -0.1, delta=1e-12)
        self.assertLess(found["image/spot_extent"], 1e-12)
        self.assertLess(abs(found["image/path_difference"]).max(), 1e-13)
        self.assertLess(abs(found["image/least_path_difference"]).max(), 1e-13)
        self.assertAlmostEqual(float(found["image/best_z"]), -1.5, delta=1e-12)

    def test_path_differences_have_the_derivatives_of_the_wave(self):
        """Rays are normal to the wave: the derivative of the path difference by the direction cosine
        is the distance from the mean at which a ray meets the plane."""
        found = self.trace(**PARALLEL, lens=[0, 0, 0, 1, 5, 0, 0.5, *GLASS], origin=[0, 0, -1], beam_radius=0.8,
                           ray_count=401, stop_plane=plane(5), image_plane=plane(9))
        off = found["image/x"] - found["image/x"].mean()
        cosine = found["exit/dx"]
        derivative = np.gradient(found["image/path_difference"], cosine)
        np.testing.assert_allclose(derivative[1:-1], -off[1:-1], atol=2e-6)

    def test_refocus(self):
        """A wave of focus 10 has its smallest spot there, and elsewhere one as wide as the cone."""
        keys = {**PARALLEL, "lens": [0, 0, 0, 1, 5, 0, 0.5, *GLASS], "origin": [0, 0, -1], "beam_radius": 0.5,
                "light": "disk", "ray_count": 200, "stop_plane": plane(5)}
        moved = self.trace(**keys, image_plane=plane(9), refocus=True)
        still = self.trace(**keys, image_plane=plane(9 + moved["image/distance"]))
        np.testing.assert_allclose(still["image/spot_radius"], moved["image/spot_radius"], rtol=1e-10)
        self.assertAlmostEqual(float(still["image/focus"]), 0, delta=1e-10)
        for beside in (-0.01, 0.01):
            other = self.trace(**keys, image_plane=plane(9 + moved["image/distance"] + beside))
            self.assertGreater(other["image/spot_radius"], moved["image/spot_radius"])
        self.assertLess(moved["image/least_path_difference_rms"], moved["image/path_difference_rms"])
        for name in "image/path_difference", "image/least_path_difference":
            np.testing.assert_allclose(moved[f"{name}_rms"], np.sqrt(np.mean(moved[name] ** 2)), rtol=1e-12)

    def test_parallel_rays_have_no_focus(self):
        found = self.trace(**PARALLEL, ray_count=5, stop_plane=plane(1), image_plane=plane(2))
        self.assertNotIn("image/focus", found)
        self.assertLess(found["image/path_difference_rms"], 1e-14)

    def test_scenes(self):
        for name in ("singlet", "rod_lens"):
            found = self.trace(config=DATA / "scenes" / f"trace_{name}.toml")
            self.assertLess(found["image/spot_radius"], 0.02)


class Refused(BodiesTest):
    KEYS = {**PARALLEL, "stop_plane": plane(5)}

    def test_bodies(self):
        for keys, message in (
                ({"lens": [0, 0, 0, 1, 0.5, 0, 1, *GLASS]}, "radii of curvature must not be below the radius"),
                ({"lens": [0, 0, 0, 1, 1, -1, 1, *GLASS]}, "faces must not meet within it"),
                ({"lens": [0, 0, 0, 1, 1, -1, 0, *GLASS]}, "lens, thickness = 0: must be positive"),
                ({"body_lens": [0, 0, 0, -1, 1, -1, 1]}, "body_lens, radius = -1: must be positive"),
                ({"lens": [0, 0, 0, 1, 5]}, "lens"),
                ({"lens": [0, 0, 0, 1, 5, 0, 1, -1.5, 0, 0, 0]}, "lens, index = -1.5: must be positive"),
                ({"ball": [0, 0, 0, 1, 1.5, -1, 0, 0]}, "ball, mu_s = -1: must not be negative"),
                ({"index_around": 1.3}, "index_around = 1.3: is a key of a body"),
                ({"body_box": [0, 0, 0, 1, 1, 1], "body_sphere": [0, 0, 0, 1]}, "give one body"),
                ({"body_sphere": [0, 0, 0, 2], "field": "luneburg"}, "inside of the rim of luneburg"),
                ({"body_sphere": [0, 0, 0, 2], "field": "parabolic", "index": 1.5, "alpha": 1}, "must be positive"),
                ({"ball": [0, 0, 0, 1, *GLASS] * 63}, "stop surfaces and bodies = 64: must be at most 62"),
                ({"ball": [0, 0, 0, 1, *GLASS] * 2}, "ball from -1 -1 -1 to 1 1 1: coincides with ball from -1 -1 -1"),
                ({"ball": [0, 0, 0, 1, *GLASS], "lens": [0, 0, -1, 1, 1, -1, 2, *GLASS]}, "coincides with"),
                ({"block": [0, 0, 1, 1, 1, 1 + 1e-14, *GLASS]}, "block from 0 0 1 to 1 1 1: is too thin"),
                ({"cylinder": [0, 0, 1, 0, 0, 1, 1, *GLASS]}, "cylinder = 0 0 1 0 0 1: must have two different ends"),
                ({"cylinder": [0, 0, 1, 0, 0, 2, 0, *GLASS]}, "cylinder, radius = 0: must be positive"),
                ({"block": [0, 0, 1, 1, 1, 2, *GLASS] * 2, "block_turns": [0, 1, 0]},
                 "block_turns = 0 1 0: requires three numbers for each of 2 bodies"),
                ({"ball": [0, 0, 0, 1, *GLASS] * 2, "ball_face": "mirror"}, "ball_face = 1: requires a word for each ball"),
                ({"lens_turns": [0, 1, 0]}, "lens_turns = 0 1 0: requires three numbers for each of 0 bodies"),
                ({"body_sphere": [0, 0, 0, 1], "connect": [0, 0, 0, 0, 0, 1], "light": None, "stop_plane": None},
                 "body_sphere")):
            self.assert_refused([message], "trace", **self.KEYS | keys)

    def test_images(self):
        for keys, message in (
                ({"image_plane": [0, 0, 1, 0, 0, 0]}, "image_plane, normal = 0 0 0: must not be 0"),
                ({"image_plane": [0, 0, 1]}, "image_plane"),
                ({"refocus": True}, "refocus"),
                ({"image_plane": plane(9), "refocus": True}, "the rays are parallel and have no focus"),
                ({"image_plane": [0, 0, 9, 1, 0, 0]}, "ray 0 is parallel to the plane"),
                ({"image_plane": plane(9), "field": "parabolic", "index": 1.5, "alpha": 0.1},
                 "rays end at different indices")):
            self.assert_refused([message], "trace", **self.KEYS | keys)


if __name__ == "__main__":
    unittest.main()
