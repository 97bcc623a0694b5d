# A ball falls on a floor and bounces; run it headless with godot --headless --path clients/godot4.
# RINGDOWN_PORT and RINGDOWN_OBJECT name another daemon and object.
extends Node3D

const Ringdown = preload("res://ringdown.gd")
const RingingBody = preload("res://ringing_body.gd")


func _ready() -> void:
	var floor_body := StaticBody3D.new()
	var plane := CollisionShape3D.new()
	plane.shape = WorldBoundaryShape3D.new()
	floor_body.add_child(plane)
	add_child(floor_body)

	var sphere := SphereShape3D.new()
	sphere.radius = 0.05
	var shape := CollisionShape3D.new()
	shape.shape = sphere
	var ball := RingingBody.new()
	ball.add_child(shape)
	ball.mass = 0.02
	ball.position = Vector3(0, 0.25, 0)
	ball.physics_material_override = PhysicsMaterial.new()
	ball.physics_material_override.bounce = 0.6
	ball.object = _setting("RINGDOWN_OBJECT", "bell")
	ball.ringdown = Ringdown.new(int(_setting("RINGDOWN_PORT", "7770")))
	add_child(ball)
	await get_tree().create_timer(3.0).timeout
	get_tree().quit()


func _setting(variable: String, fallback: String) -> String:
	return OS.get_environment(variable) if OS.has_environment(variable) else fallback
