"""Every plan under plans/ holds in simulation. `pytest.ini` names the folder."""


def test_plan_holds(benchdog, benchdog_plan):
    # A failure has the checks that failed and the path of a recording. friction=0.4 would test the same plan with smoother pads.
    benchdog.assert_holds(benchdog_plan)
