#!/usr/bin/env bash
# Runs what tells within a minute or two whether an edit holds: rules and types of both sides, and the unit and contract
# tests that neither compile for long nor run for long. tools/test.sh runs everything.

source "$(dirname "$0")/common.sh"
source tools/node.sh
source tools/beside.sh

# They compile a closed loop, fly or search a lot, or start processes: most of the processor time of the two folders.
# What an edit breaks in them shows in other files too, mostly. tests/unit/repository/test_check.py refuses what is gone.
SLOW=(
    tests/contract/test_compiled.py
    tests/contract/test_frames.py
    tests/contract/test_guests.py
    tests/contract/test_method_options.py
    tests/contract/test_method_table.py
    tests/contract/test_methods.py
    tests/contract/test_one_method.py
    tests/contract/test_pairs.py
    tests/unit/backend/db/test_beside.py
    tests/unit/backend/db/test_cli_purge.py
    tests/unit/backend/requirements/test_uploads.py
    tests/unit/campaigns/asked/test_campaigns_effort.py
    tests/unit/campaigns/densities/test_reweighting.py
    tests/unit/campaigns/test_expected_values.py
    tests/unit/campaigns/test_library.py
    tests/unit/clearance/cli/test_allow_code.py
    tests/unit/clearance/cli/test_capsule_code.py
    tests/unit/clearance/cli/test_cli.py
    tests/unit/clearance/cli/test_cli_run.py
    tests/unit/clearance/cli/test_earlier_results.py
    tests/unit/clearance/cli/test_explain.py
    tests/unit/clearance/cli/test_interrupted.py
    tests/unit/clearance/cli/test_known_regions.py
    tests/unit/clearance/cli/test_likely.py
    tests/unit/clearance/cli/test_parts_of_a_claim.py
    tests/unit/clearance/cli/test_replay.py
    tests/unit/clearance/cli/test_serve_slow_worker.py
    tests/unit/clearance/cli/test_witness.py
    tests/unit/clearance/function/test_arguments.py
    tests/unit/clearance/function/test_functions.py
    tests/unit/clearance/function/test_notebook.py
    tests/unit/clearance/function/test_rounded.py
    tests/unit/clearance/function/test_tied.py
    tests/unit/clearance/function/test_unconfirmed.py
    tests/unit/engine/attraction/test_region.py
    tests/unit/engine/kernels/test_bind.py
    tests/unit/engine/kernels/test_text.py
    tests/unit/engine/kernels/test_text_names.py
    tests/unit/engine/problem/test_problem.py
    tests/unit/engine/rare/test_bench.py
    tests/unit/engine/rare/test_estimate.py
    tests/unit/engine/search/test_auto.py
    tests/unit/engine/search/test_callback.py
    tests/unit/engine/search/test_cma_es.py
    tests/unit/engine/search/test_contrast_racing.py
    tests/unit/engine/search/test_falsification.py
    tests/unit/engine/search/test_global_clustering.py
    tests/unit/engine/search/test_lq_cma_es.py
    tests/unit/engine/search/test_mlsl.py
    tests/unit/engine/search/test_monte_carlo.py
    tests/unit/engine/search/test_nlopt_global.py
    tests/unit/engine/search/test_nsga2.py
    tests/unit/engine/search/test_portfolio.py
    tests/unit/engine/search/test_scoreboard.py
    tests/unit/engine/search/test_scoreboard_texts.py
    tests/unit/engine/stages/test_allowance.py
    tests/unit/engine/stages/test_baseline.py
    tests/unit/engine/stages/test_certify.py
    tests/unit/engine/stages/test_counting.py
    tests/unit/engine/stages/test_drive.py
    tests/unit/engine/stages/test_estimate.py
    tests/unit/engine/stages/test_findings.py
    tests/unit/engine/stages/test_front.py
    tests/unit/engine/stages/test_onward.py
    tests/unit/engine/stages/test_same_numbers.py
    tests/unit/engine/stages/test_seeds.py
    tests/unit/engine/stages/test_sensitivity.py
    tests/unit/engine/stages/test_stages.py
    tests/unit/engine/stages/test_warm.py
    tests/unit/engine/systems/test_ahead.py
    tests/unit/engine/systems/test_beyond.py
    tests/unit/engine/systems/test_cut_short.py
    tests/unit/engine/systems/test_field.py
    tests/unit/engine/systems/test_further.py
    tests/unit/engine/systems/test_rounds.py
    tests/unit/engine/systems/test_trace.py
    tests/unit/engine/systems/test_uniform.py
    tests/unit/evidence/audit/test_absent_parts.py
    tests/unit/evidence/audit/test_audit.py
    tests/unit/evidence/audit/test_baseline_forgeries.py
    tests/unit/evidence/audit/test_confirmed_cases.py
    tests/unit/evidence/audit/test_counted_forgeries.py
    tests/unit/evidence/audit/test_earlier_distributions.py
    tests/unit/evidence/audit/test_earlier_likelihoods.py
    tests/unit/evidence/audit/test_earlier_rules.py
    tests/unit/evidence/audit/test_estimate_forgeries.py
    tests/unit/evidence/audit/test_estimate_modes.py
    tests/unit/evidence/audit/test_estimate_starts.py
    tests/unit/evidence/audit/test_forged_databases.py
    tests/unit/evidence/audit/test_forgeries.py
    tests/unit/evidence/audit/test_large_nominal.py
    tests/unit/evidence/audit/test_names_of_parameters.py
    tests/unit/evidence/verdicts/test_called_violations.py
    tests/unit/evidence/verdicts/test_foreseen.py
    tests/unit/evidence/verdicts/test_kinds_of_statement.py
    tests/unit/repository/test_compose.py
    tests/unit/repository/test_readme.py
    tests/unit/repository/test_sbom.py
    tests/unit/running/catalogue/test_catalog.py
    tests/unit/running/catalogue/test_function_files.py
    tests/unit/running/catalogue/test_own_components.py
    tests/unit/running/examination/test_examination.py
    tests/unit/running/examination/test_purity.py
    tests/unit/running/processes/test_live.py
    tests/unit/running/reproduce/test_reproduce.py
    tests/unit/running/runs/test_continuation.py
    tests/unit/running/runs/test_files_that_change.py
    tests/unit/running/runs/test_losses.py
    tests/unit/running/runs/test_reaches.py
    tests/unit/running/runs/test_resume.py
    tests/unit/running/runs/test_sources.py
)
# Of files that are quick otherwise: they start several processes, each of which takes seconds.
STARTING=(
    tests/unit/repository/test_arrows.py::test_what_a_process_loads
)

frontend_types() {
    cd frontend
    npm run --silent client
    npm run --silent types
}

frontend_rules() {
    cd frontend
    node_modules/.bin/oxlint
}

"$VENV/bin/ruff" check .
"$VENV/bin/ruff" format --check .
# Every process loads these modules, also where the environment forbids to write what was compiled.
"$VENV/bin/python" -m compileall -q backend campaigns clearance worker
begin mypy "$VENV/bin/mypy"
begin tsc frontend_types
begin oxlint frontend_rules
begin pytest "$VENV/bin/pytest" -q --processes 2 tests/unit tests/contract "${SLOW[@]/#/--ignore=}" \
    "${STARTING[@]/#/--deselect=}" "$@"

ended
