"""A procedure on pictures that name nobody: each enters the chain by a person's statement, as a C-arm's image would."""

import io

import numpy as np
import pytest
from PIL import Image

from tests.system.carm import CArm
from tests.system.walk import Walk


class PictureCArm(CArm):
    """A C-arm whose images are carried over as PNG files."""

    case = None

    def expose(self, source_from_guide: np.ndarray, **elements: object) -> None:
        """Upload a picture and say whose it is, of the view and the exposure in force."""
        file = io.BytesIO()
        Image.fromarray(self.image(source_from_guide, **elements).pixel_array).save(file, "PNG")
        uploaded = self.case.room.upload_image("image/png", file.getvalue())
        requests = [event for event in self.case.record() if event["trigger"] == "exposure_requested"]
        self.case.command(
            "image-identity-stated",
            image_id=uploaded["id"],
            patient_id="P1",
            view_id=self.case.status()["chain"]["view"],
            window_id=requests[-1]["data"]["made"]["window"],
        )


@pytest.mark.timeout(300)
def test_pictures_with_a_statement_register_and_verify(case, service) -> None:
    carm = PictureCArm(service, "P1", "1.2.3")
    carm.case = case
    Walk(case, carm).to("verified")
    stated = [event["data"]["identity_by_statement"] for event in case.record() if event["trigger"] == "image_arrived"]
    assert len(stated) == 2
    assert {one["patient_id"] for one in stated} == {"P1"}
